#pragma once
#include <QObject>
#include <QPointF>
#include <QString>
#include <QVector>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "model/document.h"
#include "model/jobs/latest_task.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/volumes/reconstructor.h"
#include "voxel_arrays.h"

namespace plenoflame::desktop {

/// A camera with its picture, for a reconstruction.
struct ReconstructSource {
  SceneDocument scene;                        ///< with this camera alone
  std::optional<double> time = {};            ///< moment of a scene that changes
  std::string camera;                         ///< its name; may be empty
  std::string what;                           ///< names the picture in messages
  std::shared_ptr<const LightField> picture;  ///< null: from the file
  std::string file;                           ///< empty as well: the scene is rendered
};

/// Fields on one lattice, as found and as they are in the scene.
struct ReconstructFields {
  struct Field {
    std::string name, unit;
    std::vector<float> found, truth;  ///< x fastest; truth empty: not known
    double largest = 0;               ///< of both
  };
  VoxelPlace place;
  std::vector<Field> fields;

  /// A plane across an axis of the lattice (0, 1, 2) at a share of the way through. Rows run
  /// downwards from the highest of what goes up.
  Image slice(const std::vector<float>& values, int axis, double share) const;
};

/// Reconstructs in the background, and shows the way there.
class ReconstructJob : public QObject {
  Q_OBJECT
 public:
  enum class State { idle, running, finished, failed };
  /// Options as set_option() of ReconstructRequest takes them: name and text.
  using Options = std::vector<std::pair<std::string, std::string>>;

  explicit ReconstructJob(QObject* parent = nullptr);

  void start(std::vector<ReconstructSource> sources, const Options& options);
  /// Ends it with what was reached.
  void stop();

  /// Share of the whole work, 0 to 1; 0: not known yet.
  double share() const { return share_; }
  double remaining_seconds() const { return remaining_seconds_; }  ///< negative: not known yet
  State state() const { return state_; }
  bool stopping() const { return stopping_; }
  /// The step that is being done, or why it failed.
  const QString& text() const { return text_; }
  /// chi^2 per row, iteration by iteration; of strengths that are only tried, and of the solution.
  const QVector<QPointF>& trials() const { return trials_; }
  const QVector<QPointF>& solution() const { return solution_; }
  /// The iterate while it runs, then the result; null: there is none yet.
  const std::shared_ptr<const ReconstructFields>& fields() const { return fields_; }
  /// Null unless it is finished. Not changed any more.
  const std::shared_ptr<const FlameReconstruction>& result() const { return result_; }
  const QString& report() const { return report_; }

 signals:
  void state_changed();
  void progressed();
  void warned(const QString& message);

 private:
  struct Run;
  void run(const std::shared_ptr<Run>& run, const std::stop_token& stop);
  void tell_share(const std::shared_ptr<Run>& run, double share);
  void watch(const std::shared_ptr<Run>& run, const ReconstructionState& state,
             const Unknowns& unknowns);
  void set_state(State state);

  State state_ = State::idle;
  QString text_, report_;
  QVector<QPointF> trials_, solution_;
  double share_ = 0, remaining_seconds_ = -1;
  bool stopping_ = false;
  std::shared_ptr<const ReconstructFields> fields_;
  std::shared_ptr<const FlameReconstruction> result_;
  std::shared_ptr<Run> run_;
  LatestTask task_{Urgency::work};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
