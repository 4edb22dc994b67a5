#include "commands/render/bundles_option.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "plenoflame/base/error.h"
#include "plenoflame/render/compiled_camera.h"

namespace plenoflame::cli {

void add_bundles_option(CLI::App& command, std::vector<std::string>& names) {
  command
      .add_option("--compiled", names,
                  "Compiled cameras, one file each, in place of --rays and --seed")
      ->option_text("FILE.bundle ...")
      ->excludes("--rays")
      ->excludes("--seed");
}

NamedBundles read_bundles(const std::vector<std::string>& names, std::size_t cameras) {
  if (!names.empty() && names.size() != cameras)
    throw UsageError(
        fmt::format("--compiled: {} files for {} cameras; give one file per camera, in the order "
                    "of the cameras",
                    names.size(), cameras));
  NamedBundles bundles;
  for (const std::string& name : names)
    bundles.emplace_back(name, std::make_shared<const CompiledCamera>(read_bundle(name)));
  return bundles;
}

}  // namespace plenoflame::cli
