// A real camera's picture beside the simulated one. The pictures are written here, from a rendered
// one that is scaled, shifted and marked: how they lie on each other is known.
#include <QAction>
#include <QColor>
#include <QComboBox>
#include <QDir>
#include <QLabel>
#include <QPushButton>
#include <QStatusBar>
#include <QToolButton>
#include <QTreeWidget>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "scenes.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/image/colour_bar.h"
#include "widgets/panels/scene_panel.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class MeasuredTest : public test::SceneFixture {
  Q_OBJECT

  static constexpr int kColumns = 200, kRows = 180, kShift = 2;
  static constexpr double kBlack = 100, kGain = 2, kBrightest = 30000;
  Image simulated_;
  double counts_per_watt_ = 0;

  static std::string scene_text() {
    std::string text = test::small_scene_text();
    const std::string pitch = "pixel_pitch = \"100 um\"\n";
    text.insert(text.find(pitch) + pitch.size(),
                "gain = 2\nblack_level = 100\nbits = 16\nfull_well = 120000\n");
    return text;
  }
  /// Opens the scene and writes its picture as a camera would: moved to the right by kShift, with a
  /// lamp in the dark corner of 10 x 10 pixels.
  void prepare(const QString& picture) {
    write(file("scene.toml"), scene_text().c_str());
    QVERIFY(window_->open(file("scene.toml")));
    QVERIFY(settled());
    simulated_ = session().document().image()->channels[0].flux;
    const float top = *std::max_element(simulated_.pixels.begin(), simulated_.pixels.end());
    counts_per_watt_ = kBrightest / static_cast<double>(top);
    write_pgm(picture, kColumns, kRows);
  }
  double counts_at(int column, int row) const {
    if (column < 10 && row < 10) return kBlack + kBrightest;
    const int from = column - kShift;
    const double flux = from >= 0 && from < kColumns && row < kRows
                            ? static_cast<double>(simulated_.at(from, row))
                            : 0.0;
    return std::round(kBlack + counts_per_watt_ * flux);
  }
  void write_pgm(const QString& name, int columns, int rows) {
    QByteArray bytes = QString("P5\n%1 %2\n65535\n").arg(columns).arg(rows).toLatin1();
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const auto counts = static_cast<unsigned>(counts_at(column, row));
        bytes.append(static_cast<char>(counts >> 8));
        bytes.append(static_cast<char>(counts & 255));
      }
    write(file(name), bytes);
  }
  void choose(const QString& name) {
    answer_file_dialog(file(name));
    QVERIFY(click_menu({"File", "Measured picture..."}));
    QVERIFY(written() && settled());
  }
  void show(const QString& picture) {
    auto* const box = child<QComboBox>("shownPicture");
    QVERIFY(box->isVisible());
    box->setFocus();
    const int index = box->findText(picture);
    while (box->currentIndex() < index) QTest::keyClick(box, Qt::Key_Down);
    while (box->currentIndex() > index) QTest::keyClick(box, Qt::Key_Up);
    QCOMPARE(box->currentText(), picture);
  }
  QColor drawn(int column, int row) {
    const QImage picture = image().grab().toImage();
    const QPointF at = picture.devicePixelRatio() * image().to_widget({column + 0.5, row + 0.5});
    return QColor(picture.pixel(at.toPoint()));
  }
  static bool green(const QColor& c) {
    return c.green() > c.red() + 60 && c.green() > c.blue() + 60;
  }
  /// The brightest pixel of the simulated picture.
  QPoint brightest() const {
    const auto top = std::max_element(simulated_.pixels.begin(), simulated_.pixels.end());
    const auto place = static_cast<int>(top - simulated_.pixels.begin());
    return {place % kColumns, place / kColumns};
  }

  /// A pixel at which both pictures are bright, and alike.
  QPoint bright_in_both() const {
    QPoint best;
    double most = -1e300;
    for (int row = 0; row < kRows; ++row)
      for (int column = 10; column < kColumns; ++column) {
        const double here = static_cast<double>(simulated_.at(column, row)),
                     there = static_cast<double>(simulated_.at(column - kShift, row));
        const double worth = std::min(here, there) - 3 * std::fabs(here - there);
        if (worth > most) most = worth, best = {column, row};
      }
    return best;
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void pictureOfACameraIsHeldAgainstTheSimulation() {
    prepare("flame.pgm");
    QVERIFY(!child<QComboBox>("shownPicture")->isVisible());
    choose("flame.pgm");
    QVERIFY(session().measured().field());
    QVERIFY(until([this] { return image().caption().contains("measured: flame.pgm"); }));
    for (const QSize size : {QSize(1366, 768), QSize(1280, 720), QSize(1400, 900)})
      QCOMPARE(cut_tool(*window_, size, window_->image_panel()), QString());
    // Electrons above dark, by the scene's gain and black level.
    const Image& electrons = session().measured().field()->channels[0].flux;
    for (const QPoint at : {brightest(), QPoint(3, 4), QPoint(100, 20)}) {
      const double expected = kGain * (counts_at(at.x(), at.y()) - kBlack);
      QVERIFY2(std::fabs(static_cast<double>(electrons.at(at.x(), at.y())) - expected) <=
                   1e-5 * std::max(1.0, expected),
               qPrintable(QString::number(expected)));
    }
    QVERIFY2(window_->image_panel().describe(3, 4).contains("e-"),
             qPrintable(window_->image_panel().describe(3, 4)));
    // It is said by which gain, and another one is used at once.
    const auto said = [this] { return window_->statusBar()->currentMessage(); };
    QVERIFY2(said().startsWith("flame.pgm: 2 electrons per count (the scene's sensor.gain)"),
             qPrintable(said()));
    const float before = electrons.at(3, 4);
    const auto read = session().measured().field();
    type("camera.sensor.gain", "3");
    QVERIFY(until([&] { return session().measured().field() != read; }));
    QCOMPARE(session().measured().field()->channels[0].flux.at(3, 4), 1.5F * before);
    QVERIFY2(said().startsWith("flame.pgm: 3 electrons per count"), qPrintable(said()));
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(
        until([&] { return session().measured().field()->channels[0].flux.at(3, 4) == before; }));
    QVERIFY(until([&] { return image().image()->level(0).at(3, 4) == before; }));
    QVERIFY(written() && settled());
    auto* const bar = child<ColourBar>("imageBar");
    for (const QString& label : bar->labels()) QVERIFY2(label.endsWith(" e-"), qPrintable(label));
    // A line along a row has its values.
    const int row = brightest().y();
    drag(&image(), of_pixel(20, row), of_pixel(kColumns - 20, row), Qt::ControlModifier);
    auto* const plot = &window_->image_panel().profile_plot();
    QVERIFY(until([&] { return !plot->series().empty(); }));
    QVERIFY2(plot->y_label().contains("e-"), qPrintable(plot->y_label()));
    double top = 0, expected = 0;
    for (const QPointF& point : plot->series()[0].points) top = std::max(top, point.y());
    for (int column = 20; column < kColumns - 20; ++column)
      expected = std::max(expected, kGain * (counts_at(column, row) - kBlack));
    QVERIFY2(std::fabs(top / expected - 1) < 0.2, qPrintable(QString::number(top / expected)));
    // The registration tells the shift of one on the other.
    QVERIFY(until([this] { return session().measured().registration() != nullptr; }));
    const PictureFit fit = session().measured().registration()->whole;
    QVERIFY2(std::fabs(fit.shift.x - kShift) < 0.05 && std::fabs(fit.shift.y) < 0.05,
             qPrintable(QString("%1 %2").arg(fit.shift.x).arg(fit.shift.y)));
    QVERIFY2(std::fabs(fit.gain / (kGain * counts_per_watt_) - 1) < 0.05,
             qPrintable(QString::number(fit.gain)));
    auto* const text = child<QLabel>("registrationText");
    QVERIFY(text->isVisible() && text->text().contains("shifted by"));
    // The lamp is in the measured picture alone; where both shine the overlay is grey.
    QVERIFY(drawn(5, 5).lightness() > 100);
    show("Simulated");
    QCOMPARE(image().caption(), QString("simulated"));
    QVERIFY(drawn(5, 5).lightness() < 40);
    show("Overlay");
    QVERIFY(green(drawn(5, 5)));
    const QPoint both = bright_in_both();
    const QColor grey = drawn(both.x(), both.y());
    QVERIFY2(std::abs(grey.red() - grey.green()) < 30 && grey.red() > 120, qPrintable(grey.name()));
    // Blinking shows one after the other, by its key.
    press(Qt::Key_B);
    // The picture keeps its place, though the bar's numbers have other lengths.
    const QPoint corner = of_pixel(0, 0);
    for (const bool lamp : {true, false, true}) {
      QVERIFY(until([&] { return (drawn(5, 5).lightness() > 100) == lamp; }, 5000));
      QCOMPARE(image().caption().startsWith("measured"), lamp);
      QCOMPARE(bar->labels().back().endsWith(" e-"), lamp);
      QCoreApplication::processEvents();
      QCOMPARE(of_pixel(0, 0), corner);
      QVERIFY(!image().overlay());
    }
    press(Qt::Key_B);
    QVERIFY(image().overlay());
    // After an edit the registration is of the new picture.
    type("flames[0].scale", "0.8");
    QVERIFY(settled());
    QVERIFY(until([&] {
      return session().measured().registration() &&
             std::fabs(session().measured().registration()->whole.residual - fit.residual) > 1e-3;
    }));
    // Another scene has not taken it.
    QVERIFY(window_->open_example("lenslets-30") && settled());
    QVERIFY(!session().measured().field());
    QVERIFY(!child<QComboBox>("shownPicture")->isVisible());
    QVERIFY(image().caption().isEmpty());
  }

  void filesAreLookedForWhereTheLastOneWas() {
    prepare("flame.pgm");
    QVERIFY(QDir(file(".")).mkdir("pictures"));
    QVERIFY(QFile::rename(file("flame.pgm"), file("pictures/flame.pgm")));
    choose("pictures/flame.pgm");
    QVERIFY(session().measured().field());
    raise("reconstructGroup");
    child<QTreeWidget>("reconstructCameras")
        ->setCurrentItem(child<QTreeWidget>("reconstructCameras")->topLevelItem(0));
    const std::vector<std::pair<const char*, std::function<void()>>> questions{
        {"open", [this] { press(Qt::Key_O, Qt::ControlModifier); }},
        {"measured",
         [this] {
           QVERIFY(click_menu({"File", "Measured picture..."}));
         }},
        {"compare",
         [this] {
           QVERIFY(click_menu({"View", "Compare with a scene..."}));
         }},
        {"of a camera",
         [this] { QTest::mouseClick(child<QPushButton>("reconstructFile"), Qt::LeftButton); }},
        {"further cameras",
         [this] { QTest::mouseClick(child<QPushButton>("reconstructScene"), Qt::LeftButton); }},
        {"film", [this] {
           QVERIFY(click_menu({"Render", "Film of a parameter..."}));
           QTest::mouseClick(child<QPushButton>("filmRecord"), Qt::LeftButton);
         }}};
    for (const auto& [name, ask] : questions) {
      QString folder;
      QFileDialog().setDirectory(file("."));  // which Qt itself would begin in
      when_shown<QFileDialog>([&](QFileDialog& dialog) {
        folder = dialog.directory().dirName();
        dialog.reject();
      });
      ask();
      QVERIFY2(until([&] { return !folder.isEmpty(); }), name);
      QVERIFY2(folder == "pictures", qPrintable(name + (": " + folder)));
    }
  }

  void importedLightFieldShowsItsLattice() {
    prepare("flame.pgm");
    run(PLENOFLAME_COMMAND,
        {"import", file("flame.pgm"), "--camera", file("scene.toml"), "-o", file("flame.exr")});
    answer_file_dialog(file("flame.exr"));
    press(Qt::Key_O, Qt::ControlModifier);
    QVERIFY(until([this] { return session().measured().field() != nullptr; }));
    QVERIFY(written() && settled());
    QVERIFY(image().caption().startsWith("measured"));
    // Nothing was rendered yet: it is what the file holds.
    QVERIFY(session().document().image() == session().measured().field());
    QVERIFY2(window_->image_panel().flux_text(3, 4).endsWith("e-"),
             qPrintable(window_->image_panel().flux_text(3, 4)));
    // Its lattice.
    image().set_scale(6);
    const QImage bare = image().grab().toImage();
    press(Qt::Key_O);
    QVERIFY(until([&] { return test::difference(bare, image().grab().toImage()) > 0.01; }));
    // It ends with the picture, though its microlenses go on beyond the sensor.
    const auto outside = [this](const QImage& picture) {
      const double ratio = picture.devicePixelRatio();
      const QRectF sensor(ratio * image().to_widget(QPointF(-1, -1)),
                          ratio * image().to_widget(QPointF(kColumns + 1, kRows + 1)));
      QImage without = picture;
      for (int y = 0; y < without.height(); ++y)
        for (int x = 0; x < without.width(); ++x)
          if (sensor.contains(x, y)) without.setPixel(x, y, 0);
      return without;
    };
    image().set_scale(1);
    const QImage lattice = image().grab().toImage();
    press(Qt::Key_O);
    QVERIFY(until([&] { return test::difference(lattice, image().grab().toImage()) > 1e-3; }));
    QCOMPARE(outside(lattice), outside(image().grab().toImage()));
    press(Qt::Key_O);
    // F5 renders the scene, and the file's picture stays to be compared.
    press(Qt::Key_F5);
    QVERIFY(until([this] { return session().document().image() != session().measured().field(); }));
    QVERIFY(settled());
    QVERIFY(session().document().image()->channels[0].flux.pixels == simulated_.pixels);
    QVERIFY(until([this] { return session().measured().registration() != nullptr; }));
    QVERIFY(std::fabs(session().measured().registration()->whole.shift.x - kShift) < 0.05);
    // Chosen for the open scene it is the same as the camera's own file.
    const auto opened = session().measured().field();
    choose("flame.pgm");
    QVERIFY(session().measured().field() != opened);
    QVERIFY(session().measured().field()->channels[0].flux.pixels ==
            opened->channels[0].flux.pixels);
  }

  void whatIsNoPictureOfThisCameraIsRefused() {
    QVERIFY(!window_->open_measured(file("early.pgm")));
    QVERIFY2(window_->last_message().contains("open the scene of that camera first"),
             qPrintable(window_->last_message()));
    prepare("flame.pgm");
    write_pgm("small.pgm", 100, 90);
    choose("small.pgm");
    QVERIFY2(window_->last_message().contains("has 100 x 90 pixels, the camera's sensor 200 x 180"),
             qPrintable(window_->last_message()));
    write(file("broken.tif"), "II*\0 and nothing else");
    choose("broken.tif");
    QVERIFY2(window_->last_message().contains("broken.tif"), qPrintable(window_->last_message()));
    QVERIFY(!session().measured().field());
    QVERIFY(session().document().image_is_current());
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_measured_test() {
  return std::make_unique<MeasuredTest>();
}

#include "measured_test.moc"
