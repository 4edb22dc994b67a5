#pragma once
#include <QObject>
#include <QString>
#include <memory>
#include <optional>
#include <vector>

#include "model/document.h"
#include "model/jobs/flame_cache.h"
#include "model/jobs/latest_task.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/input_files.h"

namespace plenoflame::desktop {

/// Compiles the document's scene in the background whenever something changes that matters, and
/// hands it to whoever traces rays. While a scene has errors the last one of the same document that
/// had none stays.
class SceneCompiler : public QObject {
  Q_OBJECT
 public:
  explicit SceneCompiler(Document& document, QObject* parent = nullptr);

  /// Null until the first one is ready.
  const std::shared_ptr<const CompiledScene>& compiled() const { return compiled_; }
  bool is_current() const { return current_; }
  /// Why the present scene cannot be compiled; empty: it can, or is being so.
  const QString& failure() const { return failure_; }
  /// Compiles once more what failed: its files may be others now.
  void retry();
  const FlameCache& flames() const { return flames_; }
  /// Compiles the scene of another moment ahead of its request.
  void prepare(double time);
  /// True once the work that prepare() began is over.
  bool is_prepared() const { return !ahead_task_.busy(); }

 signals:
  /// The earlier compiled scene belongs to another document, and is gone.
  void cleared();
  /// @param changes since the scene that was compiled before
  void compiled_changed(const plenoflame::desktop::SceneChanges& changes);
  void failed(const QString& message);
  void warned(const QString& message);

 private:
  void request(const SceneChanges& changes);
  void fail(const QString& message);
  /// A compiled scene, and the marks of its files from before they were read.
  struct Compiled {
    std::shared_ptr<const CompiledScene> scene;
    std::vector<InputFile> files;
  };
  void take(Compiled compiled);

  Document& document_;
  FlameCache flames_;
  std::shared_ptr<const CompiledScene> compiled_;
  std::vector<InputFile> files_;  ///< of it
  SceneChanges pending_;          ///< of scenes that were replaced before they were compiled
  /// The scene at the moment that will probably be shown next.
  struct Ahead {
    double time = 0;
    Compiled compiled;
  };
  Ahead ahead_;
  unsigned scene_number_ = 0;  ///< of changes beside moments
  QString failure_;
  bool current_ = false;
  unsigned newest_ = 0;
  LatestTask ahead_task_{Urgency::in_reserve};
  LatestTask task_{Urgency::waited_for};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
