#include "file_set.h"

#include <filesystem>
#include <system_error>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

namespace fs = std::filesystem;

/// Calls `write` with a name; in what it says about files they have the names that they are to
/// have.
void write_as(const std::function<void(const std::string&)>& write, const std::string& name,
              const std::string& final_name) {
  const auto renamed = [&](std::string text) {
    for (auto at = text.find(name); at != std::string::npos;
         at = text.find(name, at + final_name.size()))
      text.replace(at, name.size(), final_name);
    return text;
  };
  try {
    write(name);
  } catch (const FileError& error) {
    throw FileError(renamed(error.what()));
  } catch (const InputError& error) {
    throw InputError(renamed(error.what()));
  }
}

}  // namespace

void FileSet::write(const std::string& path, const std::function<void(const std::string&)>& write) {
  const fs::path whole(path);
  const std::string folder =
      whole.parent_path().empty() ? std::string(".") : whole.parent_path().string();
  std::unique_ptr<StagingFolder>& staging = folders_[folder];
  if (!staging) staging = std::make_unique<StagingFolder>(folder);
  write_as(write, (fs::path(staging->path()) / whole.filename()).string(), path);
}

void FileSet::commit() {
  std::vector<const StagingFolder*> all;
  for (const auto& [folder, staging] : folders_) all.push_back(staging.get());
  StagingFolder::commit(all);
  folders_.clear();
}

ResultFolder::ResultFolder(const std::string& folder) : folder_(folder) {
  std::error_code error;
  made_ = fs::create_directory(folder, error);
  if (error) throw FileError("cannot make the folder '" + folder + "': " + error.message());
  try {
    staging_ = std::make_unique<StagingFolder>(folder);
  } catch (...) {
    if (made_) fs::remove(folder, error);
    throw;
  }
}

ResultFolder::~ResultFolder() {
  staging_.reset();
  std::error_code not_empty;
  if (made_) fs::remove(folder_, not_empty);
}

void ResultFolder::write(const std::function<void(const std::string&)>& write) {
  write_as(write, staging_->path(), folder_);
}

void ResultFolder::commit() {
  staging_->commit();
  made_ = false;
}

}  // namespace plenoflame::cli
