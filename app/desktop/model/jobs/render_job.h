#pragma once
#include <QObject>
#include <QString>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "model/jobs/latest_task.h"
#include "plenoflame/render/render_request.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::desktop {

/// Samples of the passes that lead up to `samples`, each several times the one before.
std::vector<int> pass_samples(int samples, int replicates);

/// Renders in the background, coarsely first. A picture of large pixels comes first, then passes,
/// each of which replaces the previous picture tile by tile. Every picture is one of the whole
/// sensor. The last pass is what the command line does with the same scene, bit for bit.
class RenderJob : public QObject {
  Q_OBJECT
 public:
  enum class State { idle, running, paused, finished, failed };

  /// One point of the curve of error against time.
  struct CurvePoint {
    double seconds = 0;  ///< spent rendering since the start, pauses not counted
    double error = 0;    ///< relative RMSE over lit pixels
  };
  struct Status {
    int pass = 0, passes = 0;  ///< counted from 1
    int samples = 0;           ///< of this pass
    double fraction = 0;       ///< of the samples of all passes
    double rays = 0;           ///< sent in this pass
    double rays_per_second = 0;
    double relative_error = -1;     ///< of the whole picture; negative: not known yet
    double seconds = 0;             ///< spent since the start
    double remaining_seconds = -1;  ///< of all passes; negative: not known yet
  };

  explicit RenderJob(QObject* parent = nullptr);

  State state() const { return state_; }
  const Status& status() const { return status_; }
  const std::vector<CurvePoint>& curve() const { return curve_; }
  /// Statistics of the last pass that was completed.
  const RenderStatistics& statistics() const { return statistics_; }

  /// Starts again. @param threads 0: one per processor
  /// @param shown a picture of the same scene and seed, of the whole sensor, to be improved; null:
  ///        none
  void start(std::shared_ptr<const CompiledScene> scene, int threads = 0,
             std::shared_ptr<const LightField> shown = nullptr);
  /// From the next start on only the finished picture is made, and not those that lead up to it.
  void set_finished_only(bool on) { finished_only_ = on; }
  /// Keeps the picture so far; resume() continues as without a break.
  void pause();
  void resume();
  /// Ends; the picture stays as it is.
  void stop();
  /// The same, and forgets what was known of it: another document is there.
  void clear();

 signals:
  void state_changed();
  void progressed();
  /// A picture, better than the one before.
  void image(const std::shared_ptr<const plenoflame::LightField>& field);
  void failed(const QString& message);

 private:
  struct Run;  ///< of the worker
  void set_state(State state);
  void forget();
  void cancel();
  void fail(const std::string& message);
  void launch();
  void make_passes();
  // These are called by the workers.
  void begin(const std::shared_ptr<Run>& run, const std::stop_token& stop);
  /// False: it was stopped.
  bool make_pass(const std::shared_ptr<Run>& run, const std::stop_token& stop);
  void show(const std::shared_ptr<Run>& run, std::shared_ptr<const LightField> field,
            const RenderStatistics* done);
  void tell(const std::shared_ptr<Run>& run, const Progress& progress);

  State state_ = State::idle;
  bool finished_only_ = false;
  Status status_;
  std::vector<CurvePoint> curve_;
  RenderStatistics statistics_;
  std::shared_ptr<Run> run_;
  LatestTask first_;  ///< the coarse picture, which somebody waits for
  LatestTask task_;   ///< last: it ends first
};

}  // namespace plenoflame::desktop
