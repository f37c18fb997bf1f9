// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>
#include <numbers>

#include "pcavr/perception/texture/texture_options.hpp"

namespace pcavr {
namespace {

using Texture = TextureOptions;
constexpr auto kTextureFields = std::to_array<OptionField<Texture>>({
    {"enabled", &Texture::enabled, 1.0, 0.0, 1.0, "", "give the static mesh a texture",
     "0: the mesh has the fused colours of its vertices; 1: the build takes longer"},
    // More than 32 take longer than a quarter of the rest of the build, where the camera is fixed.
    {"max_views", &Texture::max_views, 32, 1, 1000, "", "maximum number of images used",
     "lower: parts are seen by few images; higher: slower, more memory"},
    {"max_view_memory", &Texture::max_view_memory, 192, 16, 100'000, "MiB",
     "maximum memory of the images used", "lower: fewer large images; higher: more memory"},
    // Cell size of a grid of views; the sharpest image of each cell is kept.
    {"view_translation", &Texture::view_translation, 0.05, 1e-3, 10.0, "m",
     "distance between views up to which only the sharpest is a candidate",
     "lower: blurred images are used; higher: parts seen briefly lose their best view"},
    {"view_rotation", &Texture::view_rotation, 5.0 * std::numbers::pi / 180.0, 1e-3, 3.0, "rad",
     "angle between views up to which only the sharpest is a candidate",
     "lower: blurred images are used; higher: parts seen briefly lose their best view"},
    {"view_interval", &Texture::view_interval, 0.2, 0.0, 3600.0, "s",
     "time between views up to which only the sharpest is a candidate",
     "lower: blurred images are used; higher: what a moved body hid is seen by few images"},
    // 2048 x 1024 texels of 4 bytes, with mipmaps, are 11 MiB of a headset's memory; its panels and
    // cards need 5 of the 16 MiB that it has at 72 Hz.
    {"atlas_width", &Texture::atlas_width, 2048, 64, 16384, "px", "maximum width of the texture",
     "lower: blurred; higher: more memory on the graphics card"},
    {"atlas_height", &Texture::atlas_height, 1024, 64, 16384, "px",
     "maximum height of the texture, with those of bodies",
     "lower: blurred; higher: more memory on the graphics card"},
    // Of a box of 10 cm six charts at 1 mm have room; an eighth of the texture.
    {"bodies_edge", &Texture::bodies_edge, 512, 0, 16384, "px",
     "edge of the square that the textures of all bodies have together, each at least 64, those "
     "beyond none; taken off atlas_height; 0: bodies have none",
     "lower: bodies are blurred; higher: the scene is"},
    {"texels_per_pixel", &Texture::texels_per_pixel, 1.2, 0.1, 8.0, "",
     "texels per pixel of the nearest view, where the atlas has room",
     "lower: blurred; higher: a larger download without more detail"},
    {"best_view_exponent", &Texture::best_view_exponent, 3.0, 0.0, 20.0, "",
     "exponent of a view's weight in the mean over the views",
     "lower: errors of the poses blur the texture; higher: noise of single images, visible seams"},
    {"mask_distance", &Texture::mask_distance, 60.0, 0.0, 1000.0, "px",
     "distance from a body or the tool within which an image counts less",
     "lower: shadows of moved bodies remain; higher: fewer images for what is around bodies"},
    {"color_outlier", &Texture::color_outlier, 12.0, 1.0, 255.0, "of 255",
     "difference from the median over the views at which an image counts less",
     "lower: seams where exposure differs; higher: shadows and highlights remain"},
    {"register_color", &Texture::register_color, 1.0, 0.0, 1.0, "",
     "estimate the offset of the colour images from the depth images",
     "0: smeared where the sensor does not register them; 1: slower"},
    {"fill_support", &Texture::fill_support, 1.0, 0.0, 1.0, "",
     "show the parts of support planes that only moved things hid, marked as not seen",
     "0: holes below and behind bodies; 1: the table there is a guess"},
    {"jpeg_quality", &Texture::jpeg_quality, 88, 10, 100, "", "quality of the JPEG texture",
     "lower: artefacts; higher: a larger download"},
});
static_assert(are_valid_fields(kTextureFields));

}  // namespace

TextureOptions::TextureOptions() { set_defaults(*this, kTextureFields); }

OptionSection section_of(TextureOptions& options) {
  return make_section("texture", options, kTextureFields);
}

}  // namespace pcavr
