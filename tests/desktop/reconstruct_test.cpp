// The flame back from its pictures, by clicks alone.
#include <QComboBox>
#include <QFile>
#include <QLabel>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QTabBar>
#include <QTabWidget>
#include <QTreeWidget>
#include <algorithm>
#include <cmath>

#include "gui_tests.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_file.h"
#include "widgets/image/axes_frame.h"
#include "widgets/image/colour_bar.h"
#include "widgets/image/image_view.h"
#include "widgets/panels/reconstruct_panel.h"
#include "widgets/window/beside_window.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

namespace {

/// A small camera before a round flame of one layer, whose emission is known: kappa times the
/// source function.
constexpr const char* kRoundFlame = R"([camera]
preset = "paper-previous-60x60"
[[flames]]
kind = "layered"
position = ["1 m", "0 m", "0 m"]
[[flames.layers]]
semi_axes = ["20 mm", "20 mm", "20 mm"]
temperature = "1800 K"
absorption = "4 1/m"
[render]
samples = 64
)";

}  // namespace

class ReconstructTest : public test::WindowFixture {
  Q_OBJECT

  QPushButton* push(const char* name) { return child<QPushButton>(name); }
  void choose(const char* box, const QString& text) {
    auto* const combo = child<QComboBox>(box);
    QVERIFY(combo);
    const int index = combo->findText(text);
    QVERIFY2(index >= 0, qPrintable(text));
    combo->setFocus();
    // With the keys that move through a list.
    while (combo->currentIndex() < index) QTest::keyClick(combo, Qt::Key_Down);
    while (combo->currentIndex() > index) QTest::keyClick(combo, Qt::Key_Up);
    QCOMPARE(combo->currentText(), text);
  }
  void fill(const char* name, const QString& text) {
    auto* const line = child<QLineEdit>(name);
    QVERIFY(line);
    line->setFocus();
    line->selectAll();
    QTest::keyClicks(line, text);
    QCOMPARE(line->text(), text);
  }
  ReconstructJob& job() { return window_->reconstruct_panel().job(); }
  bool ended() {
    return until([this] { return job().state() != ReconstructJob::State::running; });
  }
  void open_round_flame() {
    begin();
    window_->resize(1366, 768);
    write(file("round.toml"), kRoundFlame);
    QVERIFY(window_->open(file("round.toml")));
    QVERIFY(settled());
    QVERIFY(click_menu({"Render", "Reconstruct the flame..."}));
    QVERIFY(dock("reconstructGroup")->isVisible());
  }

 private slots:
  void flameComesBackAndIsSaved() {
    open_round_flame();
    auto* const cameras = child<QTreeWidget>("reconstructCameras");
    QCOMPARE(cameras->topLevelItemCount(), 1);
    QCOMPARE(cameras->topLevelItem(0)->text(1), QString("in the window"));
    QVERIFY(!push("reconstructSave")->isEnabled());
    // One camera takes rings, and says why; a low window shows the begin of the group.
    QCOMPARE(child<QComboBox>("reconstructUnknowns")->currentData().toString(), QString("rings"));
    QVERIFY(child<QLabel>("reconstructWhy")->text().contains("depth"));
    QVERIFY(child<QLabel>("reconstructWhy")->isVisible());
    QVERIFY(!push("reconstructStart")->visibleRegion().isEmpty());
    choose("reconstructUnknowns", "Ellipsoidal layers");
    fill("reconstructGrid", "4");
    fill("reconstructBin", "3");
    fill("reconstructRays", "8");
    QTest::mouseClick(push("reconstructStart"), Qt::LeftButton);
    QVERIFY(ended());
    QCOMPARE(job().text(), QString("finished"));
    // The strength that is chosen was tried last: few iterations of the solution are left.
    QVERIFY(job().trials().size() > 1 && !job().solution().isEmpty());
    // The first state, of a strength that is tried, explains less than the solution does.
    const double first = (job().trials() + job().solution()).front().y(),
                 last = job().solution().back().y();
    QVERIFY2(last < first, qPrintable(QString("%1, %2").arg(first).arg(last)));
    const auto& fields = *job().fields();
    const auto found_field =
        std::find_if(fields.fields.begin(), fields.fields.end(),
                     [](const ReconstructFields::Field& f) { return f.name == "emission"; });
    QVERIFY(found_field != fields.fields.end());
    const auto& emission = *found_field;
    // By arithmetic: absorption times sigma T^4 / pi, all wavelengths together.
    const double truth = 4 * 5.670374419e-8 * std::pow(1800.0, 4) / std::acos(-1.0);
    // Between the innermost sample and the second one, where no layer ends.
    const auto& size = fields.place.size;
    const std::size_t middle = (size[2] / 2 * size[1] + size[1] / 2) * size[0] + size[0] / 2;
    const double found = static_cast<double>(emission.found[middle]);
    QVERIFY2(std::abs(found / truth - 1) < 0.25,
             qPrintable(QString("%1 and %2").arg(found).arg(truth)));
    QVERIFY(child<QPlainTextEdit>("reconstructReport")->toPlainText().contains("chi^2"));
    // Value, deviation, truth and difference are seen, with their colours and axes in millimetres.
    for (const char* name : {"reconstructFound", "reconstructTruth", "reconstructDeviation",
                             "reconstructDifference"}) {
      auto* const view = child<ImageView>(name);
      auto* const frame = qobject_cast<AxesFrame*>(view->parentWidget());
      QVERIFY2(frame && view->image() && !view->image()->empty(), name);
      QCOMPARE(frame->across().name, QString("y [mm]"));
      QCOMPARE(frame->up().name, QString("z [mm]"));
      QVERIFY(std::abs(frame->across().first + frame->across().last) < 1e-6);  // the axis: y = 0
    }
    // Deviation and difference have one scale: their largest size where the flame is lit.
    const auto deviation = std::find_if(
        fields.fields.begin(), fields.fields.end(),
        [](const ReconstructFields::Field& f) { return f.name == "emission_deviation"; });
    QVERIFY(deviation != fields.fields.end());
    float size_of_errors = 0;
    for (std::size_t i = 0; i < emission.found.size(); ++i)
      if (static_cast<double>(emission.found[i]) >= 0.05 * emission.largest)
        size_of_errors =
            std::max({size_of_errors, deviation->found[i],
                      emission.truth[i] > 0 ? std::abs(emission.found[i] - emission.truth[i]) : 0});
    const auto& tone = child<ImageView>("reconstructDifference")->tone_settings();
    QVERIFY(tone.is_signed);
    QCOMPARE(tone.white, static_cast<double>(size_of_errors));
    QCOMPARE(child<ImageView>("reconstructDeviation")->tone_settings().white, tone.white);
    int signed_bars = 0;
    for (const auto* bar : window_->light_field_panel().findChildren<ColourBar*>())
      if (bar->isVisible() && bar->labels().front().startsWith('-')) {
        ++signed_bars;
        QCOMPARE(bar->labels()[2], QString("0"));
      }
    QCOMPARE(signed_bars, 1);
    // Beside the truth in three dimensions, both seen.
    QTest::mouseClick(push("reconstructBeside"), Qt::LeftButton);
    auto* const beside = window_->findChild<BesideWindow*>();
    QVERIFY(beside && QTest::qWaitForWindowExposed(beside));
    const QImage pair = beside->picture();
    const QString folder = qEnvironmentVariable("PLENOFLAME_TOUR");
    if (!folder.isEmpty()) pair.save(folder + "/beside.png");
    // Each half has its flame, the box's edges, grey lines, and their lengths, light texts.
    for (const int side : {0, 1}) {
      int flame = 0, edges = 0, texts = 0;
      for (int y = pair.height() / 10; y < pair.height() * 85 / 100; ++y)
        for (int x = side * pair.width() / 2; x < (side + 1) * pair.width() / 2; ++x) {
          const QColor c = pair.pixelColor(x, y);
          const bool grey = c.saturation() < 20;
          flame += c.saturation() > 100 && c.value() > 100 ? 1 : 0;
          edges += grey && std::abs(c.value() - 128) < 8 ? 1 : 0;
          texts += c.saturation() < 40 && c.blue() > c.red() && c.value() > 190 ? 1 : 0;
        }
      QVERIFY2(flame > 1000 && edges > 300 && texts > 60,
               qPrintable(QString("%1 %2 %3").arg(flame).arg(edges).arg(texts)));
    }
    beside->close();
    answer_file_dialog(file("back"));
    QTest::mouseClick(push("reconstructSave"), Qt::LeftButton);
    QVERIFY(written());
    const QString info = run(PLENOFLAME_COMMAND, {"info", file("back.vdb")});
    QVERIFY2(info.contains("emission"), qPrintable(info));
    end();
  }

  /// The picture of the pages: a candle from one camera, with the defaults of the panel.
  void pictureOfACandle() {
    const QString folder = qEnvironmentVariable("PLENOFLAME_TOUR");
    if (folder.isEmpty()) return;
    begin();
    run(PLENOFLAME_COMMAND, {"flame", "candle", "-o", file("candle.vdb")});
    QVERIFY(QFile::copy(PLENOFLAME_EXAMPLES "/reconstruct-front.toml", file("front.toml")));
    QVERIFY(window_->open(file("front.toml")));
    QVERIFY(settled());
    QVERIFY(click_menu({"Render", "Reconstruct the flame..."}));
    choose("reconstructUnknowns", "Rings (round flame)");
    fill("reconstructRays", "64");
    QTest::mouseClick(push("reconstructStart"), Qt::LeftButton);
    QVERIFY(
        QTest::qWaitFor([&] { return job().state() != ReconstructJob::State::running; }, 900000));
    QCOMPARE(job().text(), QString("finished"));
    window_->save_screenshot(folder + "/reconstruct.png");
    end();
  }

  /// The grids of a file with their ranges, as `plenoflame info` tells them.
  QString grids_of(const QString& path) {
    QString text = run(PLENOFLAME_COMMAND, {"info", path, "--json"});
    return text.mid(text.indexOf("\"grids\""));
  }

  void temperatureInRingsOfTwoCamerasAsTheCommandHasIt() {
    begin();
    // The same camera from two sides; the second one is like the first.
    QByteArray text = kRoundFlame;
    text.replace("[camera]\n", "[[cameras]]\nname = \"front\"\n");
    text.replace("[[flames]]\n",
                 "[[cameras]]\nname = \"side\"\nlike = \"front\"\n"
                 "position = [\"1 m\", \"-1 m\", \"0 m\"]\nlook_direction = [0, 1, 0]\n"
                 "[[flames]]\n");
    write(file("two.toml"), text);
    QVERIFY(window_->open(file("two.toml")));
    QVERIFY(settled());
    QVERIFY(click_menu({"Render", "Reconstruct the flame..."}));
    auto* const cameras = child<QTreeWidget>("reconstructCameras");
    QCOMPARE(cameras->topLevelItemCount(), 2);
    QCOMPARE(cameras->topLevelItem(1)->text(1), QString("will be rendered"));
    choose("reconstructFind", "Temperature");
    choose("reconstructUnknowns", "Rings (round flame)");
    QVERIFY(!child<QComboBox>("reconstructSolver")->isEnabled());
    QVERIFY(child<QLineEdit>("reconstructRingsAxis")->isEnabled());
    QVERIFY(!child<QLineEdit>("reconstructRatios")->isEnabled());
    fill("reconstructGrid", "5,7");
    fill("reconstructRays", "8");
    fill("reconstructBin", "3");
    fill("reconstructNoise", "0.02");
    fill("reconstructIterations", "20");
    QTest::mouseClick(push("reconstructStart"), Qt::LeftButton);
    QVERIFY(ended());
    QCOMPARE(job().text(), QString("finished"));
    answer_file_dialog(file("window"));
    QTest::mouseClick(push("reconstructSave"), Qt::LeftButton);
    QVERIFY(written());
    // Beside the truth in three dimensions.
    QTest::mouseClick(push("reconstructBeside"), Qt::LeftButton);
    auto* const beside = window_->findChild<BesideWindow*>();
    QVERIFY(beside && QTest::qWaitForWindowExposed(beside));
    beside->close();
    // Slices are to scale, though the rings' voxels are oblong.
    auto* const slice = child<ImageView>("reconstructFound");
    auto* const frame = qobject_cast<AxesFrame*>(slice->parentWidget());
    QVERIFY(frame && slice->image());
    const double seen = 1.0 * slice->image()->width() / slice->image()->height();
    const double is =
        (frame->across().last - frame->across().first) / (frame->up().last - frame->up().first);
    QVERIFY2(std::abs(seen / is - 1) < 0.02, qPrintable(QString("%1 %2").arg(seen).arg(is)));
    run(PLENOFLAME_COMMAND, {"render", file("two.toml"), "--quiet", "-o", file("raw.exr")});
    const auto by_command = [&](const QString& noise, const QString& name) {
      run(PLENOFLAME_COMMAND, {"reconstruct",
                               file("two.toml"),
                               "--images",
                               file("raw-front.exr"),
                               file("raw-side.exr"),
                               "--find",
                               "temperature",
                               "--absorption",
                               "scene",
                               "--unknowns",
                               "rings",
                               "--grid",
                               "5,7",
                               "--rays",
                               "8",
                               "--bin",
                               "3",
                               "--noise",
                               noise,
                               "--iterations",
                               "20",
                               "--quiet",
                               "-o",
                               file(name)});
      return grids_of(file(name));
    };
    const QString its = by_command("0.02", "command.vdb");
    QVERIFY(its.contains("temperature"));
    QCOMPARE(grids_of(file("window.vdb")), its);
    QVERIFY(by_command("0", "other.vdb") != its);  // the noise that was typed counts
    end();
  }

  void whatIsWrongIsSaidAndAStopKeepsTheIterate() {
    open_round_flame();
    choose("reconstructUnknowns", "Voxels");
    fill("reconstructGrid", "none");
    QTest::mouseClick(push("reconstructStart"), Qt::LeftButton);
    QVERIFY(ended());
    // The field's own name, and no option of the command.
    QVERIFY2(child<QLabel>("reconstructState")->text().startsWith("grid takes"),
             qPrintable(job().text()));
    QVERIFY(window_->light_field_panel().tab() == LightFieldPanel::Tab::reconstruction);
    fill("reconstructGrid", "12");
    fill("reconstructRays", "8");
    fill("reconstructBin", "2");
    fill("reconstructIterations", "100000");
    QTest::mouseClick(push("reconstructStart"), Qt::LeftButton);
    // Stopped once there is an iterate on display.
    QVERIFY(until([this] { return job().fields() != nullptr; }));
    // The panel tells the share of the work and the time that is left, and that it stops.
    const auto* const state = child<QLabel>("reconstructState");
    QVERIFY(until([state] { return state->text().contains(" %, "); }));
    QVERIFY2(state->text().contains("to go"), qPrintable(state->text()));
    QTest::mouseClick(push("reconstructStop"), Qt::LeftButton);
    QVERIFY(!push("reconstructStop")->isEnabled());
    QVERIFY2(state->text() == "stopping" || job().state() != ReconstructJob::State::running,
             qPrintable(state->text()));
    QVERIFY(ended());
    QVERIFY2(job().text().startsWith("stopped") || job().text() == "finished",
             qPrintable(job().text()));
    end();
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_reconstruct_test() {
  return std::make_unique<ReconstructTest>();
}

#include "reconstruct_test.moc"
