#pragma once
#include <QWidget>

#include "model/jobs/ray_selector.h"

class QLabel;
class QPushButton;
class QSplitter;
class QTableWidget;

namespace plenoflame::desktop {

/// The rays of the selection as a table, and the surfaces that the chosen one meets.
class RaysPanel : public QWidget {
  Q_OBJECT
 public:
  explicit RaysPanel(RaySelector& rays, QWidget* parent = nullptr);
  QTableWidget& table() { return *table_; }
  /// Value of the picture at the selected pixel, to be said beside the rays' own sum; empty: it
  /// has none.
  void set_pixel_of_picture(const QString& text);
  /// Number of the ray that is chosen; -1: none.
  int chosen() const;

 signals:
  void ray_chosen(int ray);
  /// The pixel of a ray, by double click or Return on its line.
  void pixel_requested(int column, int row);
  void export_requested();

 protected:
  void changeEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void fill();
  void fill_surfaces(int ray);
  void show_title();
  void colour_endings();
  void fit_tables();

  RaySelector& rays_;
  QLabel* title_;
  QSplitter* split_;
  QTableWidget *table_, *surfaces_;
  QPushButton* export_;
  QString pixel_of_picture_;
};

}  // namespace plenoflame::desktop
