#pragma once
#include <QObject>
#include <QString>
#include <memory>
#include <string>

#include "model/document.h"
#include "model/jobs/latest_task.h"
#include "plenoflame/calibration/registration.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/sensor_spec.h"

namespace plenoflame::desktop {

/// Reads a picture of a real camera. It is a raw light field (.exr) from `plenoflame import`, or
/// the camera's own file (TIFF, PNG, PGM, JPEG; several frames are averaged). The counts of such a
/// file become electrons by the gain and black level of the scene's sensor.
/// @param scene of the camera alone
/// @return of the whole sensor, 0 outside of a window
/// @throws FileError, InputError: no picture of this sensor; Cancelled
std::shared_ptr<const LightField> read_measured(const std::string& path, const Scene& scene,
                                                const Execution& execution);
/// How the counts of a camera's own file became electrons, in a sentence.
QString gain_in_words(const QString& name, const SensorSpec& sensor);
/// True if a light field came from a real camera.
bool is_measured(const LightField& field);

/// The measured picture that the simulated one is held against, and how the two lie on each other.
class MeasuredPicture : public QObject {
  Q_OBJECT
 public:
  explicit MeasuredPicture(Document& document, QObject* parent = nullptr);

  /// Null: there is none.
  const std::shared_ptr<const LightField>& field() const { return field_; }
  const QString& name() const { return name_; }
  /// Path of a camera's own file, whose counts became electrons; empty: it is none.
  const QString& counts_path() const { return counts_path_; }
  /// @param counts_path see there
  void set(std::shared_ptr<const LightField> field, const QString& name,
           const QString& counts_path = {});
  /// The same picture, with other numbers.
  void renew(std::shared_ptr<const LightField> field);
  void clear() { set(nullptr, {}); }
  /// Gain and shift against the simulated picture, once both are there; null: not known.
  const std::shared_ptr<const Registration>& registration() const { return registration_; }
  /// The same in words, or why it is not known; empty: there is nothing to say.
  const QString& registration_text() const { return text_; }

 signals:
  void changed();
  void renewed();
  /// The scene's sensor counts light in another way than the one that the picture was read with.
  void outdated();
  void registration_changed();

 private:
  void on_scene(const SceneChanges& changes);
  void on_image();
  void forget_registration();

  Document& document_;
  std::shared_ptr<const LightField> field_;
  SensorSpec sensor_;  ///< of the scene, when the picture was read
  QString name_, counts_path_, text_;
  std::shared_ptr<const Registration> registration_;
  unsigned newest_ = 0;
  LatestTask task_{Urgency::in_reserve};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
