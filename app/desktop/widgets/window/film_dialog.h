#pragma once
#include <QDialog>
#include <QElapsedTimer>
#include <QImage>
#include <QTemporaryDir>
#include <QTimer>
#include <functional>
#include <memory>
#include <vector>

#include "model/document.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QProcess;
class QProgressBar;
class QPushButton;
class QSpinBox;

namespace plenoflame::desktop {

class FileChooser;

/// Text of a value between two others, by its share of the way from one to the other. Components of
/// vectors each move. @throws InputError where the key is no number, or a text is none
std::string between(const std::string& path, const std::string& from, const std::string& to,
                    double share);

/// A film of one parameter that moves from one value to another. Each step gives a picture, with
/// the value below it. The
/// pictures become files, or a film by ffmpeg if that is installed. At the end the scene is as
/// before.
class FilmDialog : public QDialog {
  Q_OBJECT
 public:
  /// Something that is filmed: its name and a function that draws it.
  struct View {
    QString name;
    std::function<QImage()> picture;
    bool shows_space = false;  ///< the 3-D view is seen in it
  };
  /// @param ready whether everything that is shown is that of the present scene
  FilmDialog(Document& document, std::vector<View> views, std::function<bool()> ready,
             FileChooser& chooser, QWidget* parent = nullptr);
  ~FilmDialog() override;
  /// The parameter that is moved, with ends to both sides of its present value.
  void set_parameter(const QString& path);
  /// Begins; file .png: numbered pictures, .mp4 or .gif: a film.
  void record(const QString& file);
  bool is_recording() const { return frame_ >= 0; }
  /// The word that stands in the dialog at the end, or why it failed.
  QString message() const;
  void reject() override;

 signals:
  /// @param space whether the 3-D view is filmed
  void began(bool space);
  void ended();
  void failed(const QString& message);

 private:
  void ask();
  void step();
  void set_frame();
  void assemble();
  void finish(const QString& message, bool good);
  std::string frame_name(int frame) const;

  Document& document_;
  std::vector<View> views_;
  std::function<bool()> ready_;
  FileChooser& chooser_;
  QComboBox *parameter_, *view_;
  QLineEdit *from_, *to_;
  QSpinBox *frames_, *rate_;
  QPushButton *record_, *stop_;
  QProgressBar* bar_;
  QLabel* message_;
  QTimer timer_;
  int frame_ = -1, settled_ = 0;
  bool moved_ = false;  ///< the scene has been changed
  QString file_;
  std::string before_;  ///< value of the parameter
  std::unique_ptr<QTemporaryDir> folder_;
  QProcess* encoder_ = nullptr;
};

}  // namespace plenoflame::desktop
