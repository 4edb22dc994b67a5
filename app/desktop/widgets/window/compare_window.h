#pragma once
#include <QDialog>
#include <QTimer>
#include <array>
#include <memory>

#include "model/session.h"

class QLabel;

namespace plenoflame::desktop {

class ImageView;
class SceneView;

/// Two scenes side by side: 3-D and picture, with the same view, selection and scale of values.
class CompareWindow : public QDialog {
  Q_OBJECT
 public:
  /// @param mine the scene of the main window; must outlive this
  explicit CompareWindow(Session& mine, QWidget* parent = nullptr);
  ~CompareWindow() override;
  /// Opens the scene on the right. @throws FileError, InputError
  void open(const QString& file);
  Session& other() { return *sessions_[1]; }
  /// Value that is white in both pictures [W]; 0: there are none yet.
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
  double white_ = 0;
  bool following_ = false;
};

}  // namespace plenoflame::desktop
