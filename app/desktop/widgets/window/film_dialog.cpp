#include "widgets/window/film_dialog.h"

#include <QBuffer>
#include <QComboBox>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPainter>
#include <QProcess>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QStandardPaths>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "model/scene_values.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "widgets/controls/file_chooser.h"

namespace plenoflame::desktop {
namespace {

constexpr int kFilmPoll = 5;      ///< [ms]
constexpr int kSettledPolls = 2;  ///< that must find everything at rest before a picture
constexpr int kMostFrames = 5000;

bool can_move(const SchemaKey& key) {
  return key.type == ValueType::number || key.type == ValueType::integer ||
         key.type == ValueType::vector2 || key.type == ValueType::vector3;
}

constexpr double kSpan = 0.1;                         ///< of the value, to each side
constexpr double kAtZero = 0.1;                       ///< [SI unit] that a value of 0 goes up to
constexpr double kLineLetters = 0.03;                 ///< height of letters, of the picture's
constexpr int kLeastLineLetters = 12;                 ///< [pixel]
constexpr auto kUsualEnd = ".focus.object_distance";  ///< that is moved where nothing was chosen

/// Three digits read well.
double rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double digits = std::pow(10.0, std::floor(std::log10(std::fabs(value))) - 2);
  return std::round(value / digits) * digits;
}

/// One end of a sensible span around a value. @param side -1 or 1
SchemaValue end_of_span(const SchemaKey& key, const SchemaValue& value, double side) {
  const auto moved = [&](double x, double reach) {
    if (reach == 0) return side > 0 ? kAtZero : 0.0;
    return x == 0 ? 0.0 : rounded(x + side * kSpan * x);
  };
  SchemaValue end = value;
  if (const auto* const number = std::get_if<double>(&value)) {
    end = moved(*number, *number);
  } else if (const auto* const whole = std::get_if<std::int64_t>(&value)) {
    const double by = std::max(1.0, kSpan * std::fabs(static_cast<double>(*whole)));
    end = *whole + static_cast<std::int64_t>(std::llround(side * by));
  } else if (const auto* const v = std::get_if<Vec2>(&value)) {
    const double reach = std::hypot(v->x, v->y);
    end = Vec2{moved(v->x, reach), moved(v->y, reach)};
  } else if (const auto* const w = std::get_if<Vec3>(&value)) {
    const double reach = length(*w);
    end = Vec3{moved(w->x, reach), moved(w->y, reach), moved(w->z, reach)};
  }
  return in_range(key, end) ? end : value;
}

/// The picture above a line that says which value it is of.
QImage with_line(const QImage& picture, const QString& text) {
  const int letters =
      std::max(kLeastLineLetters, static_cast<int>(std::lround(kLineLetters * picture.height())));
  QImage whole(picture.width(), picture.height() + 2 * letters, QImage::Format_RGB32);
  whole.fill(QColor(13, 14, 17));
  QImage part = picture;
  part.setDevicePixelRatio(1);
  QPainter painter(&whole);
  painter.drawImage(0, 0, part);
  QFont font = painter.font();
  font.setPixelSize(letters);
  painter.setFont(font);
  const QRect line(letters / 2, picture.height(), picture.width() - letters, 2 * letters);
  // The value is at the end, and stays where there is little room.
  const QString said = QFontMetrics(font, &whole).elidedText(text, Qt::ElideLeft, line.width());
  painter.setPen(QColor(226, 228, 231));
  painter.drawText(line, Qt::AlignLeft | Qt::AlignVCenter, said);
  return whole;
}

QString ffmpeg() {
  return QStandardPaths::findExecutable("ffmpeg");
}

}  // namespace

std::string between(const std::string& path, const std::string& from, const std::string& to,
                    double share) {
  const SchemaKey* const key = find_value(path);
  if (!key || !can_move(*key)) throw InputError(path + " is no number that can be moved");
  const SchemaValue a = value_from_text(*key, from), b = value_from_text(*key, to);
  const auto mix = [&](double x, double y) { return x + share * (y - x); };
  const SchemaValue value = std::visit(
      [&](const auto& x) -> SchemaValue {
        using Value = std::decay_t<decltype(x)>;
        const Value y = std::get<Value>(b);
        if constexpr (std::is_same_v<Value, double>) {
          return mix(x, y);
        } else if constexpr (std::is_same_v<Value, std::int64_t>) {
          return static_cast<std::int64_t>(
              std::llround(mix(static_cast<double>(x), static_cast<double>(y))));
        } else if constexpr (std::is_same_v<Value, Vec2>) {
          return Vec2{mix(x.x, y.x), mix(x.y, y.y)};
        } else if constexpr (std::is_same_v<Value, Vec3>) {
          return Vec3{mix(x.x, y.x), mix(x.y, y.y), mix(x.z, y.z)};
        } else {
          return x;
        }
      },
      a);
  check_range(*key, value);
  return value_to_text(*key, value);
}

FilmDialog::FilmDialog(Document& document, std::vector<View> views, std::function<bool()> ready,
                       FileChooser& chooser, QWidget* parent)
    : QDialog(parent),
      document_(document),
      views_(std::move(views)),
      ready_(std::move(ready)),
      chooser_(chooser),
      parameter_(new QComboBox(this)),
      view_(new QComboBox(this)),
      from_(new QLineEdit(this)),
      to_(new QLineEdit(this)),
      frames_(new QSpinBox(this)),
      rate_(new QSpinBox(this)),
      record_(new QPushButton(tr("Record..."), this)),
      stop_(new QPushButton(tr("Stop"), this)),
      bar_(new QProgressBar(this)),
      message_(new QLabel(this)) {
  setObjectName("filmDialog");
  setWindowTitle(tr("Film"));
  parameter_->setObjectName("filmParameter");
  parameter_->setToolTip(tr("The number that is moved; its value stands below each picture"));
  int usual = -1;
  for (const std::string& path : value_paths(document_.scene())) {
    const SchemaKey* const key = find_value(path);
    if (!key || !can_move(*key)) continue;
    parameter_->addItem(QString::fromStdString(path));
    if (usual < 0 && path.ends_with(kUsualEnd)) usual = parameter_->count() - 1;
  }
  parameter_->setCurrentIndex(std::max(0, usual));
  view_->setObjectName("filmView");
  for (const View& view : views_) view_->addItem(view.name);
  from_->setObjectName("filmFrom");
  from_->setToolTip(tr("Value of the first picture, with its unit"));
  to_->setObjectName("filmTo");
  to_->setToolTip(tr("Value of the last picture, with its unit"));
  frames_->setObjectName("filmFrames");
  frames_->setRange(2, kMostFrames);
  frames_->setValue(50);
  rate_->setRange(1, 60);
  rate_->setValue(12);
  rate_->setSuffix(tr(" per second"));
  record_->setObjectName("filmRecord");
  stop_->setObjectName("filmStop");
  stop_->setEnabled(false);
  message_->setObjectName("filmMessage");
  message_->setWordWrap(true);
  message_->setText(ffmpeg().isEmpty()
                        ? tr("Pictures are numbered files (.png). With ffmpeg installed, .mp4 and "
                             ".gif can be written as well.")
                        : tr("A name that ends in .mp4 or .gif gives a film, .png pictures with "
                             "numbers."));
  auto* buttons = new QHBoxLayout;
  buttons->addWidget(bar_, 1);
  buttons->addWidget(record_);
  buttons->addWidget(stop_);
  auto* form = new QFormLayout(this);
  form->addRow(tr("Parameter"), parameter_);
  form->addRow(tr("From"), from_);
  form->addRow(tr("To"), to_);
  form->addRow(tr("Pictures"), frames_);
  form->addRow(tr("Shown"), rate_);
  form->addRow(tr("Of"), view_);
  form->addRow(buttons);
  form->addRow(message_);
  connect(parameter_, &QComboBox::currentTextChanged, this, &FilmDialog::set_parameter);
  connect(record_, &QPushButton::clicked, this, &FilmDialog::ask);
  connect(stop_, &QPushButton::clicked, this, [this] { finish(tr("stopped"), false); });
  connect(&timer_, &QTimer::timeout, this, &FilmDialog::step);
  set_parameter(parameter_->currentText());
  resize(460, sizeHint().height());
}

FilmDialog::~FilmDialog() {
  if (encoder_) {
    encoder_->disconnect();
    encoder_->kill();
    encoder_->waitForFinished();
  }
}

QString FilmDialog::message() const {
  return message_->text();
}

void FilmDialog::set_parameter(const QString& path) {
  if (path.isEmpty() || is_recording()) return;
  if (parameter_->currentText() != path) {
    const int index = parameter_->findText(path);
    if (index < 0) return;
    parameter_->setCurrentIndex(index);  // comes back here
    return;
  }
  const std::string name = path.toStdString();
  const SchemaKey& key = *find_value(name);
  const SchemaValue value = key.get(document_.scene(), parse_path(name).indices);
  for (const auto& [line, side] : {std::pair{from_, -1.0}, {to_, 1.0}})
    line->setText(QString::fromStdString(value_to_text(key, end_of_span(key, value, side))));
}

void FilmDialog::ask() {
  const bool films = !ffmpeg().isEmpty();
  const QString file = chooser_.file_to_write(
      this, tr("Record the film"), films ? "film.mp4" : "film.png",
      films ? tr("Film (*.mp4 *.gif);;Pictures (*.png)") : tr("Pictures (*.png)"));
  if (!file.isEmpty()) record(file);
}

void FilmDialog::record(const QString& file) {
  const QString ending = QFileInfo(file).suffix().toLower();
  const std::string path = parameter_->currentText().toStdString();
  try {
    if (ending != "png" && ending != "mp4" && ending != "gif")
      throw UsageError("'" + file.toStdString() + "' must end in .mp4, .gif or .png");
    if (ending != "png" && ffmpeg().isEmpty())
      throw UsageError(
          "ffmpeg is not installed (Debian package ffmpeg), which puts films together: choose "
          "pictures (.png)");
    for (const double share : {0.0, 1.0}) {
      try {
        static_cast<void>(
            between(path, from_->text().toStdString(), to_->text().toStdString(), share));
      } catch (const InputError& error) {
        throw InputError(path + ": " + error.what());
      }
    }
    if (between(path, from_->text().toStdString(), to_->text().toStdString(), 0) ==
        between(path, from_->text().toStdString(), to_->text().toStdString(), 1))
      throw InputError(path + ": From and To are the same value, so that nothing would move");
    before_ = value_text(document_.scene(), path);
    file_ = file;
    check_writable((ending == "png" ? QString::fromStdString(frame_name(0)) : file).toStdString());
  } catch (const Error& error) {
    message_->setText(QString::fromUtf8(error.what()));
    emit failed(message_->text());
    return;
  }
  message_->clear();  // a refusal that stood there is over
  folder_ = std::make_unique<QTemporaryDir>();
  bar_->setRange(0, frames_->value());
  record_->setEnabled(false);
  stop_->setEnabled(true);
  moved_ = false;
  frame_ = 0;
  emit began(views_[static_cast<std::size_t>(view_->currentIndex())].shows_space);
  set_frame();
  timer_.start(kFilmPoll);
}

std::string FilmDialog::frame_name(int frame) const {
  const QFileInfo info(file_);
  return info.dir()
      .filePath(QString("%1.%2.png").arg(info.completeBaseName()).arg(frame + 1, 4, 10, QChar('0')))
      .toStdString();
}

void FilmDialog::set_frame() {
  const std::string path = parameter_->currentText().toStdString();
  const double share = static_cast<double>(frame_) / (frames_->value() - 1);
  settled_ = 0;
  try {
    const Scene before = document_.scene();
    document_.set_value(
        path, between(path, from_->text().toStdString(), to_->text().toStdString(), share), "film");
    moved_ |= !(before == document_.scene());
    if (!document_.is_valid())
      for (const SceneIssue& issue : document_.issues())
        if (issue.is_error) throw InputError(to_string(issue));
  } catch (const Error& error) {
    finish(QString::fromUtf8(error.what()), false);
  }
}

void FilmDialog::step() {
  if (!is_recording() || encoder_) return;
  settled_ = ready_() ? settled_ + 1 : 0;
  if (settled_ < kSettledPolls) return;
  const std::string path = parameter_->currentText().toStdString();
  const QImage picture =
      with_line(views_[static_cast<std::size_t>(view_->currentIndex())].picture(),
                QString::fromStdString(path + " = " + value_text(document_.scene(), path)));
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  picture.save(&buffer, "PNG");
  const QString inside = folder_->filePath(QString("%1.png").arg(frame_, 5, 10, QChar('0')));
  QFile out(inside);
  // The last picture is read as soon as this one is written.
  if (!out.open(QIODevice::WriteOnly) || out.write(bytes) != bytes.size() || !out.flush()) {
    finish(tr("'%1' cannot be written").arg(inside), false);
    return;
  }
  bar_->setValue(++frame_);
  if (frame_ < frames_->value())
    set_frame();
  else
    assemble();
}

void FilmDialog::assemble() {
  const QString ending = QFileInfo(file_).suffix().toLower();
  if (ending == "png") {
    try {
      for (int i = 0; i < frames_->value(); ++i) {
        QFile in(folder_->filePath(QString("%1.png").arg(i, 5, 10, QChar('0'))));
        if (!in.open(QIODevice::ReadOnly)) throw FileError("a picture of the film is gone");
        const QByteArray bytes = in.readAll();
        write_file(frame_name(i), {bytes.constData(), static_cast<std::size_t>(bytes.size())});
      }
    } catch (const Error& error) {
      return finish(QString::fromUtf8(error.what()), false);
    }
    return finish(tr("%1 pictures written: %2 and those after it")
                      .arg(frames_->value())
                      .arg(QString::fromStdString(frame_name(0))),
                  true);
  }
  const QString film = folder_->filePath("film." + ending);
  QStringList arguments{"-y",
                        "-loglevel",
                        "error",
                        "-framerate",
                        QString::number(rate_->value()),
                        "-i",
                        folder_->filePath("%05d.png")};
  // Sides of films are even numbers of pixels.
  if (ending == "mp4")
    arguments << "-pix_fmt"
              << "yuv420p"
              << "-vf"
              << "pad=ceil(iw/2)*2:ceil(ih/2)*2";
  // 256 colours that are chosen from the film itself.
  if (ending == "gif")
    arguments << "-filter_complex"
              << "split[all][shown];[all]palettegen[colours];[shown][colours]paletteuse";
  arguments << film;
  encoder_ = new QProcess(this);
  connect(encoder_, QOverload<int, QProcess::ExitStatus>::of(&QProcess::finished), this,
          [this, film](int code, QProcess::ExitStatus) {
            const QString said = QString::fromUtf8(encoder_->readAllStandardError()).trimmed();
            encoder_->deleteLater();
            encoder_ = nullptr;
            QFile in(film);
            if (code != 0 || !in.open(QIODevice::ReadOnly))
              return finish(tr("ffmpeg failed: %1").arg(said.section('\n', 0, 0)), false);
            try {
              const QByteArray bytes = in.readAll();
              write_file(file_.toStdString(),
                         {bytes.constData(), static_cast<std::size_t>(bytes.size())});
            } catch (const Error& error) {
              return finish(QString::fromUtf8(error.what()), false);
            }
            finish(tr("%1 written").arg(file_), true);
          });
  encoder_->start(ffmpeg(), arguments);
}

void FilmDialog::finish(const QString& message, bool good) {
  if (!is_recording()) return;
  timer_.stop();
  frame_ = -1;
  if (encoder_) {
    encoder_->disconnect();
    encoder_->kill();
    encoder_->deleteLater();
    encoder_ = nullptr;
  }
  folder_.reset();
  // All of its steps were one edit.
  if (moved_ && value_text(document_.scene(), parameter_->currentText().toStdString()) != before_)
    document_.undo();
  emit ended();
  record_->setEnabled(true);
  stop_->setEnabled(false);
  message_->setText(message);
  if (!good) emit failed(message);
}

void FilmDialog::reject() {
  finish(tr("stopped"), false);
  QDialog::reject();
}

}  // namespace plenoflame::desktop
