#pragma once
#include <QString>
#include <QWidget>
#include <memory>
#include <string>
#include <vector>

#include "model/jobs/reconstruct_job.h"
#include "model/session.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QLayout;
class QLineEdit;
class QPlainTextEdit;
class QPushButton;
class QTreeWidget;
class QTreeWidgetItem;

namespace plenoflame::desktop {

class BesideWindow;
class FileChooser;
class PlotWidget;
class SlicesPage;

/// The flame back from its pictures: cameras and pictures, what is looked for, the way there, and
/// the result beside the flame of the scene.
class ReconstructPanel : public QWidget {
  Q_OBJECT
 public:
  ReconstructPanel(Session& session, FileChooser& chooser, QWidget* parent = nullptr);
  ~ReconstructPanel() override;

  ReconstructJob& job() { return job_; }
  /// The page with curve, slices and report, for the large view.
  QWidget& result() { return *result_; }
  /// Takes a picture for a camera, by its number in the list. @param file empty: its own again
  void set_picture(int row, const QString& file);
  /// Adds the cameras of another scene. @throws FileError, InputError
  void add_scene(const QString& file);

 signals:
  void failed(const QString& message);
  void save_requested();
  /// It has begun: its page is to be seen.
  void began();
  void warned(const QString& message);

 private:
  /// A camera that may be taken.
  struct Row {
    SceneDocument scene;
    std::string camera;
    bool of_document = false;
    QTreeWidgetItem* item = nullptr;
    QString file;  ///< of its picture; empty: its own
  };

  QWidget* make_form();
  QLayout* make_pictures(QWidget* page);
  void make_choices(QWidget* page);
  QLayout* make_buttons();
  void make_result();
  void fill_cameras();
  void show_pictures();
  void show_choices();
  void propose_unknowns();
  void show_job();
  void start();
  void choose_file();
  void choose_scene();
  void add_row(Row row, bool taken);
  std::shared_ptr<const LightField> picture_of(const Row& row) const;

  Session& session_;
  FileChooser& chooser_;
  ReconstructJob job_;
  std::vector<Row> rows_;
  QWidget* result_ = nullptr;
  QTreeWidget* cameras_ = nullptr;
  QComboBox *find_ = nullptr, *unknowns_ = nullptr, *absorption_ = nullptr, *channel_ = nullptr,
            *solver_ = nullptr;
  QLineEdit *grid_ = nullptr, *centre_ = nullptr, *size_ = nullptr, *rings_axis_ = nullptr,
            *ratios_ = nullptr, *noise_ = nullptr, *strength_ = nullptr, *rays_ = nullptr,
            *bin_ = nullptr, *iterations_ = nullptr;
  QCheckBox* behind_dark_ = nullptr;
  QPushButton *start_ = nullptr, *stop_ = nullptr, *save_ = nullptr, *beside_ = nullptr,
              *own_ = nullptr;
  QLabel *state_ = nullptr, *why_ = nullptr;
  bool unknowns_chosen_ = false;  ///< by the user
  PlotWidget* curve_ = nullptr;
  SlicesPage* slices_ = nullptr;
  QPlainTextEdit* report_ = nullptr;
  BesideWindow* window_ = nullptr;
};

}  // namespace plenoflame::desktop
