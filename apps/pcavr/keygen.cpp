// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "pcavr/teleoperation/link/link_keys.hpp"

#include "commands.hpp"

namespace pcavr::app {
namespace {

struct KeygenArguments {
  std::string name;
  std::string folder;
};

Expected<CommandResult> keygen(const KeygenArguments& arguments) {
  const Expected<LinkKeyFiles> files = generate_link_keys(arguments.folder, arguments.name);
  if (!files) return files.error();
  CommandResult result;
  result.summary = "secret key " + files->secret_file.string() + " (stays on this machine)\n" +
                   "public key " + files->public_file.string() + " (copy it to the other site)\n";
  result.json = {{"secret", files->secret_file.string()}, {"public", files->public_file.string()}};
  return result;
}

}  // namespace

void add_keygen(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("keygen", "Create the keys of one of two sites (CurveZMQ)");
  command->footer("Example:\n  pcavr keygen alice -o ~/pcavr-keys");
  auto arguments = std::make_shared<KeygenArguments>();
  command->add_option("name", arguments->name, "Name of the site or person")->required();
  command->add_option("-o,--output", arguments->folder, "Folder for NAME.key and NAME.pub")
      ->required();
  command->callback([arguments, &action] {
    action = [arguments](const Observer&) { return keygen(*arguments); };
  });
}

}  // namespace pcavr::app
