#include "vtk_commands.h"

#include <dlfcn.h>

#include <filesystem>
#include <memory>
#include <system_error>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

namespace fs = std::filesystem;

/// The library beside the command: in the build tree, or where it is installed.
void* load() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::string tried;
  for (const char* place : {"plugins", PLENOFLAME_PLUGIN_FOLDER}) {
    const fs::path path = (folder / place / "libplenoflame_vtk_commands.so").lexically_normal();
    if (!fs::exists(path, error)) {
      tried += (tried.empty() ? "" : ", ") + path.string();
      continue;
    }
    // For the rest of the run: what it made may outlive any handle.
    if (void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return library;
    const char* const reason = dlerror();
    throw FileError("cannot load what needs VTK: " + std::string(reason ? reason : path.string()));
  }
  throw FileError(
      "cannot load what needs VTK: there is no " + tried +
      " (the Debian package plenoflame-vtk has it, or a build with PLENOFLAME_WITH_VTK)");
}

template <class Function>
Function* find(const char* name) {
  void* const address = dlsym(load(), name);
  if (!address)
    throw FileError("the library for VTK is of another version: it has no " + std::string(name));
  return reinterpret_cast<Function*>(address);
}

}  // namespace

void make_picture(const PictureRequest& request) {
  find<void(const PictureRequest&)>("plenoflame_make_picture")(request);
}

std::vector<ImportedFlame> import_flames(const FlameImportRequest& request,
                                         const Execution& execution) {
  std::vector<ImportedFlame> files;
  find<void(const FlameImportRequest&, const Execution&, std::vector<ImportedFlame>&)>(
      "plenoflame_import_flames")(request, execution, files);
  return files;
}

std::vector<SimulationArray> list_simulation_arrays(const std::string& file,
                                                    const Execution& execution) {
  std::vector<SimulationArray> arrays;
  find<void(const std::string&, const Execution&, std::vector<SimulationArray>&)>(
      "plenoflame_list_simulation_arrays")(file, execution, arrays);
  return arrays;
}

}  // namespace plenoflame
