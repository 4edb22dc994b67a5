#include "model/jobs/scene_compiler.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_schema.h"

namespace plenoflame::desktop {
namespace {

SceneChanges both(SceneChanges a, const SceneChanges& b) {
  const bool only_time = b.time && (a.time || !a.any());
  a.camera |= b.camera;
  a.flames |= b.flames;
  a.solids |= b.solids;
  a.channels |= b.channels;
  a.sampling |= b.sampling;
  a.samples |= b.samples;
  a.develop |= b.develop;
  a.names |= b.names;
  a.opened |= b.opened;
  a.time = only_time;
  return a;
}

/// Path of the key for which a compilation failed; empty: unknown.
/// @param flame number of the one that could not be loaded; -1: none
std::string key_of_failure(const SceneDocument& state, int flame, const std::string& message) {
  if (flame >= 0) {
    const std::string key = "flames[" + std::to_string(flame) + "]";
    return state.scene.flames[static_cast<std::size_t>(flame)].kind == FlameKind::vdb
               ? key + ".file"
               : key;
  }
  // Otherwise by the message: it begins with the key's place, or names the file.
  for (const std::string& path : scene_paths(state.scene)) {
    const SourcePosition place = state.positions.find(path);
    if (place.line > 0 && message.starts_with(to_string(place) + ":")) return path;
    if (!path.ends_with(".file")) continue;
    const std::string name = get_text(state.scene, path);
    if (!name.empty() && message.find(name) != std::string::npos) return path;
  }
  return {};
}

/// A loader that remembers which flame could not be loaded; -1: none.
MediumLoader watched(MediumLoader loader, const Scene& scene, std::atomic<int>& failed) {
  return [loader = std::move(loader), &scene, &failed](
             const FlameSpec& flame, const std::string& folder,
             const std::vector<SourceFunction>& channels, const Execution& execution) {
    try {
      return loader(flame, folder, channels, execution);
    } catch (const Cancelled&) {
      throw;
    } catch (const std::exception&) {
      const auto found = std::find(scene.flames.begin(), scene.flames.end(), flame);
      if (found != scene.flames.end()) failed = static_cast<int>(found - scene.flames.begin());
      throw;
    }
  };
}

}  // namespace

SceneCompiler::SceneCompiler(Document& document, QObject* parent)
    : QObject(parent), document_(document) {
  connect(&document_, &Document::scene_changed, this, &SceneCompiler::request);
}

void SceneCompiler::request(const SceneChanges& changes) {
  if (!changes.image()) return;
  pending_ = both(pending_, changes);
  current_ = false;
  if (!changes.time) {
    ahead_ = {};
    ahead_task_.cancel();
    ++scene_number_;
  }
  failure_.clear();
  document_.set_unreadable(nullptr);
  if (changes.opened) {
    compiled_ = nullptr;
    emit cleared();
  }
  const unsigned number = ++newest_;
  if (!document_.is_valid()) {
    task_.cancel();
    for (const SceneIssue& issue : document_.issues())
      if (issue.is_error) {
        fail(QString::fromStdString(to_string(issue)));
        return;
      }
    return;
  }
  const SceneDocument state = document_.scene_of_camera();
  const std::optional<double> time = document_.time();
  if (changes.time && ahead_.compiled.scene && time == ahead_.time) {
    task_.cancel();
    // Not at once: other listeners are still notified of the change.
    post(this, [this, number, compiled = std::exchange(ahead_, {}).compiled] {
      if (number == newest_) take(compiled);
    });
    return;
  }
  // Between two moments of a scene the files are others, and each is what it was.
  const bool moment = pending_.time;
  task_.request([this, state, time, moment, like = compiled_, files_like = files_,
                 number](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    execution.message = [&](Severity severity, const std::string& text) {
      if (severity != Severity::warning) return;
      post(this, [this, text] { emit warned(QString::fromStdString(text)); });
    };
    std::atomic<int> flame{-1};
    try {
      flames_.next_generation();
      const Scene scene = Document::at_moment(state, time);
      Compiled compiled{nullptr, input_files(scene)};
      const bool same_files = moment || compiled.files == files_like;
      compiled.scene = std::make_shared<const CompiledScene>(
          compile(scene, watched(flames_.loader(), scene, flame), execution, state.positions,
                  {same_files ? like.get() : nullptr}));
      post(this, [this, number, compiled] {
        if (number == newest_) take(compiled);
      });
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      const std::string message = error.what();
      const std::string key = key_of_failure(state, flame, message);
      post(this, [this, number, message, key] {
        if (number != newest_) return;
        SceneIssue issue;
        issue.is_error = true;
        issue.key = key;
        issue.message = message;
        document_.set_unreadable(&issue);
        fail(QString::fromStdString(message));
      });
    }
  });
}

void SceneCompiler::take(Compiled compiled) {
  compiled_ = std::move(compiled.scene);
  files_ = std::move(compiled.files);
  current_ = true;
  emit compiled_changed(std::exchange(pending_, {}));
}

void SceneCompiler::prepare(double time) {
  if (!current_ || (ahead_.compiled.scene && ahead_.time == time)) return;
  ahead_ = {};
  ahead_task_.request([this, time, number = scene_number_, like = compiled_,
                       state = document_.scene_of_camera()](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      const Scene scene = Document::at_moment(state, time);
      Compiled compiled{nullptr, input_files(scene)};
      compiled.scene = std::make_shared<const CompiledScene>(
          compile(scene, flames_.loader(), execution, state.positions, {like.get()}));
      post(this, [this, time, number, compiled] {
        if (number == scene_number_) ahead_ = {time, compiled};
      });
    } catch (const std::exception&) {  // what is wrong is said when the moment comes
    }
  });
}

void SceneCompiler::fail(const QString& message) {
  failure_ = message;
  emit failed(message);
}

void SceneCompiler::retry() {
  if (failure_.isEmpty()) return;
  SceneChanges changes;
  changes.flames = true;
  request(changes);
}

}  // namespace plenoflame::desktop
