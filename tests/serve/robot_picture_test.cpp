// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/robot_picture.hpp"

#include <string>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

class Others final : public ContentSource {
 public:
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const override {
    if (path != "/api/scene.json") return std::shared_ptr<const Content>();
    return std::make_shared<const Content>(Content{"application/json", "{}", false});
  }
};

std::string body_at(const RobotPicture& pictures, std::string_view path) {
  const auto found = pictures.find(path).value();
  return found ? found->body : "none";
}

TEST(RobotPicture, IsTheNewestBesideTheScene) {
  const Others others;
  RobotPicture pictures(others);
  EXPECT_EQ(body_at(pictures, "/api/scene.json"), "{}");
  EXPECT_EQ(body_at(pictures, "/api/robot/1.jpg"), "none");
  pictures.set({1.0, 4, 4, {'a'}}, 1);
  EXPECT_EQ(body_at(pictures, "/api/robot/1.jpg"), "a");
  pictures.set({2.0, 4, 4, {'b'}}, 2);
  EXPECT_EQ(body_at(pictures, "/api/robot/1.jpg"), "b");
  EXPECT_EQ(pictures.find("/api/robot/2.jpg").value()->media_type, "image/jpeg");
  for (const char* const path : {"/api/robot/3.jpg", "/api/robot/01.jpg", "/api/robot/.jpg",
                                 "/api/robot/-1.jpg", "/api/robot/2.jpg.jpg"}) {
    EXPECT_EQ(body_at(pictures, path), "none") << path;
  }
}

}  // namespace
}  // namespace pcavr
