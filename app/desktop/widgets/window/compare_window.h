#pragma once
#include <QDialog>
#include <QTimer>
#include <array>
#include <memory>

#include "model/image_display.h"
#include "model/jobs/latest_task.h"
#include "model/session.h"

class QLabel;

namespace plenoflame::desktop {

class ColourBar;
class ImageView;
class SceneView;

/// Two scenes side by side: 3-D and picture, with the same view, selection and scale of values.
class CompareWindow : public QDialog {
  Q_OBJECT
 public:
  /// @param mine the scene of the main window; must outlive this
  /// @param tone colours and scale of both pictures; the value that is white is found here
  CompareWindow(Session& mine, const ToneSettings& tone, QWidget* parent = nullptr);
  ~CompareWindow() override;
  /// Opens the scene on the right. @throws FileError, InputError
  void open(const QString& file);
  Session& other() { return *sessions_[1]; }
  /// The colours of both pictures.
  void set_map(ColourMap map);
  /// Irradiance that is white in both pictures [W/m^2]; 0: there is none in both. Channels of
  /// other names are of other light: then each picture has a scale of its own.
  double white() const { return white_; }

 private:
  void fill(std::size_t side);
  void set_tones();
  void follow_view(std::size_t side);
  Session own_;
  std::array<Session*, 2> sessions_;
  std::array<QLabel*, 2> titles_{};
  std::array<SceneView*, 2> scenes_{};
  std::array<ImageView*, 2> images_{};
  std::array<ColourBar*, 2> bars_{};
  ToneSettings tone_;
  double white_ = 0;
  bool following_ = false;
  std::array<LatestTask, 2> tasks_{LatestTask(Urgency::waited_for),
                                   LatestTask(Urgency::waited_for)};  ///< last: they end first
};

}  // namespace plenoflame::desktop
