#include "model/recovery.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::desktop {
namespace {

namespace fs = std::filesystem;
constexpr const char* kStem = "recovery-";
constexpr const char* kMarkStem = "running-";
constexpr const char* kFileMark = "# file: ";

/// The process that a copy or mark belongs to; 0: it is none.
int process_of(const fs::path& path, const std::string& stem, const char* extension) {
  const std::string name = path.stem().string();
  if (path.extension() != extension || name.rfind(stem, 0) != 0) return 0;
  const std::string number = name.substr(stem.size());
  int process = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), process);
  return error == std::errc{} && end == number.data() + number.size() ? process : 0;
}

bool is_running(int process) {
  return kill(process, 0) == 0 || errno == EPERM;
}

}  // namespace

Recovery::Recovery(std::string folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  path_ = (fs::path(folder_) / (kStem + std::to_string(getpid()) + ".toml")).string();
  mark_ = (fs::path(folder_) / (kMarkStem + std::to_string(getpid()))).string();
  try {
    write_file(mark_, "");
  } catch (const Error&) {  // no mark then: nothing else depends on it
  }
}

Recovery::~Recovery() {
  std::error_code error;
  fs::remove(path_, error);
  fs::remove(mark_, error);
}

bool Recovery::ended_badly() {
  std::vector<fs::path> marks;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    const int process = process_of(entry.path(), kMarkStem, "");
    if (process > 0 && entry.path() != mark_ && !is_running(process)) marks.push_back(entry.path());
  }
  for (const fs::path& mark : marks) fs::remove(mark, error);
  return !marks.empty();
}

void Recovery::keep(const Document& document) {
  if (!document.is_modified()) {
    std::error_code error;
    fs::remove(path_, error);
    return;
  }
  // Its own folder means nothing where it is found again: the files that it names are given whole.
  const Scene scene = moved_to(document.scene(), path_);
  write_file(path_, kFileMark + document.file() + "\n" + write_scene(scene));
}

std::vector<RecoveredScene> Recovery::left_behind() const {
  std::vector<RecoveredScene> scenes;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    const int process = process_of(entry.path(), kStem, ".toml");
    if (process <= 0 || entry.path() == path_) continue;
    if (is_running(process)) continue;
    try {
      RecoveredScene scene;
      scene.path = entry.path().string();
      scene.text = read_file(scene.path);
      if (scene.text.rfind(kFileMark, 0) == 0) {
        const std::size_t begin = std::string(kFileMark).size();
        scene.file = scene.text.substr(begin, scene.text.find('\n') - begin);
      }
      scenes.push_back(std::move(scene));
    } catch (const Error&) {  // unreadable: nothing to recover
    }
  }
  return scenes;
}

void Recovery::discard(const RecoveredScene& scene) {
  std::error_code error;
  fs::remove(scene.path, error);
}

}  // namespace plenoflame::desktop
