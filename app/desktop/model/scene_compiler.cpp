#include "model/scene_compiler.h"

#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame::desktop {
namespace {

SceneChanges both(SceneChanges a, const SceneChanges& b) {
  a.camera |= b.camera;
  a.flames |= b.flames;
  a.solids |= b.solids;
  a.channels |= b.channels;
  a.sampling |= b.sampling;
  a.samples |= b.samples;
  a.develop |= b.develop;
  a.names |= b.names;
  return a;
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
  const unsigned number = ++newest_;
  if (!document_.is_valid()) {
    task_.cancel();
    for (const SceneIssue& issue : document_.issues())
      if (issue.is_error) {
        emit failed(QString::fromStdString(to_string(issue)));
        return;
      }
    return;
  }
  const SceneDocument state{document_.scene(), document_.positions()};
  task_.request([this, state, number](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    execution.message = [&](Severity severity, const std::string& text) {
      if (severity != Severity::warning) return;
      post(this, [this, text] { emit warned(QString::fromStdString(text)); });
    };
    try {
      flames_.next_generation();
      auto compiled = std::make_shared<const CompiledScene>(
          compile(state.scene, flames_.loader(), execution, state.positions));
      post(this, [this, number, compiled] {
        if (number != newest_) return;
        compiled_ = compiled;
        current_ = true;
        emit compiled_changed(std::exchange(pending_, {}));
      });
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      const std::string message = error.what();
      post(this, [this, number, message] {
        if (number == newest_) emit failed(QString::fromStdString(message));
      });
    }
  });
}

}  // namespace plenoflame::desktop
