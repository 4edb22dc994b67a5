// Pictures by a compiled camera. References: what the command makes of the same scene by the same
// file, and its messages.
#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QSlider>
#include <QStatusBar>
#include <memory>
#include <vector>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "scenes.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class CompiledTest : public test::SceneFixture {
  Q_OBJECT

  PixelValues flux() { return session().document().image()->channels[0].flux.pixels; }
  void open_small() {
    write(file("small.toml"), test::small_scene_text().c_str());
    QVERIFY(window_->open(file("small.toml")));
    QVERIFY(settled());
  }
  void compile(const QString& scene, const QStringList& more = {}) {
    run(PLENOFLAME_COMMAND, QStringList{"compile", scene, "--margin", "30 mm", "--error", "2%",
                                        "--quiet", "-o", file("camera.bundle")} +
                                more);
    QVERIFY(QFile::exists(file("camera.bundle")));
  }
  void use(const QString& bundle) {
    answer_file_dialog(bundle);
    QVERIFY(click_menu({"Render", "Use compiled camera..."}));
    QVERIFY(written() && settled());
  }
  /// The command's picture of the scene as it is in the window.
  PixelValues of_the_command(const QStringList& more = {}) {
    write_scene_file(file("now.toml").toStdString(), session().document().scene());
    run(PLENOFLAME_COMMAND,
        QStringList{"render", file("now.toml"), "--quiet", "-o", file("now.exr")} + more);
    return read_light_field(file("now.exr").toStdString()).channels[0].flux.pixels;
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void sliderOfTheFlameShowsTheExactPicture() {
    open_small();
    compile(file("small.toml"));
    const auto by_rays = flux();
    use(file("camera.bundle"));
    QCOMPARE(child<QLabel>("renderState")->text(), QString("finished, by the compiled camera"));
    const QStringList option{"--compiled", file("camera.bundle")};
    QVERIFY(flux() == of_the_command(option));
    QVERIFY(flux() != by_rays);
    // The slider of a number of the flame: every picture on the way is whole and of its scene.
    std::vector<std::shared_ptr<const LightField>> pictures;
    QObject here;
    QObject::connect(&session().document(), &Document::image_changed, &here, [&] {
      if (session().document().image()) pictures.push_back(session().document().image());
    });
    window_->scene_panel().reveal("flames[0].scale");
    auto* const slider = child<QSlider>("parameterSlider");
    QVERIFY(slider && slider->isEnabled());
    slider->setFocus();
    for (int step = 0; step < 3; ++step) {
      QTest::keyClick(slider, Qt::Key_Right);
      QVERIFY(settled());
    }
    QVERIFY(pictures.size() >= 3);
    for (const auto& picture : pictures) {
      QVERIFY(picture->complete);
      QCOMPARE(picture->estimator, std::string("compiled"));
    }
    QVERIFY(flux() == of_the_command(option));
    // Rays again.
    QVERIFY(click_menu({"Render", "Follow rays again, without camera.bundle"}));
    QVERIFY(settled());
    QVERIFY(flux() == of_the_command());
    QVERIFY(!child<QAction>("actionFollowRays")->isEnabled());
  }

  void anotherCameraIsRefusedInTheCommandsWords() {
    open_small();
    compile(file("small.toml"), {"--set", "camera.focus.object_distance=1.1 m"});
    const auto before = flux();
    use(file("camera.bundle"));
    const QString said = window_->last_message();
    QVERIFY2(said.contains("belongs to another camera"), qPrintable(said));
    QProcess command;
    command.start(PLENOFLAME_COMMAND, {"render", file("small.toml"), "--compiled",
                                       file("camera.bundle"), "-o", file("x.exr")});
    QVERIFY(command.waitForFinished(test::kPatience));
    const QString its = QString::fromUtf8(command.readAllStandardError());
    QVERIFY2(its.contains(said), qPrintable(its + " / " + said));
    QVERIFY(flux() == before);
    QVERIFY(!child<QAction>("actionFollowRays")->isEnabled());
    // No bundle at all.
    write(file("no.bundle"), "nothing of the kind");
    use(file("no.bundle"));
    QVERIFY2(window_->last_message().contains("no.bundle"), qPrintable(window_->last_message()));
    // A part of the sensor.
    compile(file("small.toml"), {"--window", "0,0,100,100"});
    use(file("camera.bundle"));
    QVERIFY2(window_->last_message().contains("100 x 100 pixels"),
             qPrintable(window_->last_message()));
  }

  void afterAnEditOfTheCameraRaysAreFollowed() {
    open_small();
    compile(file("small.toml"));
    use(file("camera.bundle"));
    const auto compiled = flux();
    type("camera.focus.object_distance", "1.1 m");
    QVERIFY(settled());
    QVERIFY2(window_->statusBar()->currentMessage().contains("belongs to another camera"),
             qPrintable(window_->statusBar()->currentMessage()));
    QVERIFY(flux() == of_the_command());
    // Taken back, it is the compiled camera's scene again.
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(settled());
    QVERIFY(flux() == compiled);
    // A flame beyond the region, too.
    type("flames[0].scale", "20");
    QVERIFY(settled());
    QVERIFY2(window_->statusBar()->currentMessage().contains("beyond the region"),
             qPrintable(window_->statusBar()->currentMessage()));
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_compiled_test() {
  return std::make_unique<CompiledTest>();
}

#include "compiled_test.moc"
