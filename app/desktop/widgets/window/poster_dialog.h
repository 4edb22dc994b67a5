#pragma once
#include <QColor>
#include <QDialog>
#include <QImage>
#include <QSize>

class QCheckBox;
class QComboBox;
class QSpinBox;

namespace plenoflame::desktop {

class ImagePanel;
class SceneView;

/// A picture for paper or a lecture, of any size.
struct Poster {
  enum class Of { scene, light_field, both } of = Of::both;
  QSize size;  ///< [pixel]
  QColor background;
  bool scale_bar = true;
};

/// Asks what a poster shows.
class PosterDialog : public QDialog {
  Q_OBJECT
 public:
  explicit PosterDialog(QWidget* parent = nullptr);
  Poster poster() const;

 private:
  QComboBox *of_, *background_;
  QSpinBox *width_, *height_;
  QCheckBox* scale_bar_;
};

/// Redraws the contents of both views in the resolution of the poster.
QImage make_poster(const Poster& poster, SceneView& scene, const ImagePanel& image);

}  // namespace plenoflame::desktop
