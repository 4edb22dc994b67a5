#include <QVTKOpenGLNativeWidget.h>
#include <unistd.h>
#include <QApplication>
#include <QCommandLineParser>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QIcon>
#include <QSettings>
#include <QStandardPaths>
#include <QSurfaceFormat>
#include <QTimer>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>

#include "display.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/base/version.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/pixel_values.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/window/main_window.h"

// The destructor of pixels, whose copies in files with -O1 visit each of them: the linker takes
// this one.
template class std::vector<float, plenoflame::ZeroedAllocator<float>>;

namespace {

constexpr int kPollInterval = 50;         ///< [ms]
constexpr int kScreenshotDeadline = 300;  ///< [s]

int fail(int status, const QString& message) {
  std::cerr << "plenoflame-desktop: error: " << message.toStdString() << '\n';
  return status;
}

/// The reason why no window can be shown; empty: one can. Some displays are missing or refuse a
/// connection (another user's, or that of a closed session). Qt itself would then end the process
/// with lines about plug-ins. The connection is kept, because a virtual X server restarts when its
/// last client leaves.
std::string why_no_window(std::optional<plenoflame::views::DisplayConnection>& connection) {
  const QByteArray platform = qgetenv("QT_QPA_PLATFORM");
  if (!platform.isEmpty() && !platform.startsWith("xcb") && !platform.startsWith("wayland"))
    return {};
  if (!platform.startsWith("xcb") && !qEnvironmentVariableIsEmpty("WAYLAND_DISPLAY")) return {};
  const std::string name = qgetenv("DISPLAY").toStdString();
  const std::string advice =
      "put xvfb-run -a in front of the command (Debian packages xvfb and xauth)";
  if (name.empty())
    return "there is no display (DISPLAY and WAYLAND_DISPLAY are empty); log in with one, or " +
           advice;
  connection.emplace();
  if (connection->why_not().empty()) return {};
  return "the display '" + name + "' cannot be opened; see that it runs and is yours, or " + advice;
}

/// True if the arguments request a text only, which needs no window.
bool asks_for_text(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](const std::string_view argument) {
    return argument == "-h" || argument == "--help" || argument == "-v" || argument == "--version";
  });
}

/// The last words of a crash in any thread: a word on where the work is, then the end that it would
/// have been. Only what may be called in a signal handler.
void say_goodbye(int signal) {
  constexpr std::string_view kText =
      "plenoflame-desktop: ended unexpectedly. What was not saved is offered at the next start; "
      "please report what you did.\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kText.data(), kText.size());
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

int main(int argc, char** argv) {
  using plenoflame::desktop::MainWindow;
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS})
    std::signal(signal, say_goodbye);
  std::optional<plenoflame::views::DisplayConnection> connection;
  if (const std::string why = why_no_window(connection); !why.empty()) {
    if (!asks_for_text(argc, argv)) return fail(1, QString::fromStdString(why));
    qputenv("QT_QPA_PLATFORM", "offscreen");
  }
  QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
#if QT_VERSION < QT_VERSION_CHECK(6, 0, 0)
  QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
#endif
  QApplication application(argc, argv);
  QApplication::setApplicationName("plenoflame-desktop");
  QApplication::setOrganizationName("plenoflame");
  QApplication::setApplicationVersion(QString::fromUtf8(
      plenoflame::version().data(), static_cast<int>(plenoflame::version().size())));
  QApplication::setWindowIcon(QIcon(":/plenoflame-desktop.svg"));

  QCommandLineParser parser;
  parser.setApplicationDescription("What a light-field camera sees of a flame.");
  parser.addHelpOption();
  parser.addVersionOption();
  parser.addPositionalArgument("FILE", "Scene (.toml), flame (.vdb) or raw light field (.exr)",
                               "[FILE]");
  const QCommandLineOption screenshot(
      "screenshot", "After FILE was loaded and rendered, save a picture of the window and end",
      "OUT.png");
  const QCommandLineOption size("size", "Size of the window in pixels, e.g. 1500x950", "WxH");
  const QCommandLineOption pixel("pixel", "Select this pixel", "X,Y");
  const QCommandLineOption part(
      "part", "What the 3-D view shows: scene, flame, camera, array or pixel", "PART");
  const QCommandLineOption dock(
      "panel", "Panel to bring to the front: Rendering, Rays, Histogram, ...", "NAME");
  const QCommandLineOption dark("dark", "Dark theme");
  const QCommandLineOption depth("depth", "Refocus on this distance, with unit", "DEPTH");
  parser.addOptions({screenshot, size, pixel, part, dock, dark, depth});
  parser.process(application);
  if (parser.positionalArguments().size() > 1)
    return fail(2, "give one file at most (see plenoflame-desktop --help)");

  const bool unattended = parser.isSet(screenshot);
  if (unattended) {
    try {  // before anything is waited for
      plenoflame::check_writable(parser.value(screenshot).toStdString());
    } catch (const plenoflame::Error& error) {
      return fail(1, error.what());
    }
  }
  std::unique_ptr<QSettings> settings;
  if (unattended)  // what somebody did before must not show
    settings = std::make_unique<QSettings>(QString(), QSettings::IniFormat);
  else
    settings = std::make_unique<QSettings>();
  const QString data = QStandardPaths::writableLocation(QStandardPaths::AppDataLocation);
  MainWindow window(std::move(settings), unattended ? std::string() : data.toStdString());
  window.set_unattended(unattended);
  if (parser.isSet(size)) {
    int w = 0, h = 0;
    if (std::sscanf(parser.value(size).toUtf8().constData(), "%dx%d", &w, &h) != 2 || w < 200 ||
        h < 200)
      return fail(2, "--size: '" + parser.value(size) + "' is not of the form 1500x950");
    window.resize(w, h);
  }
  window.appear();
  QString wrong;
  if (!parser.positionalArguments().isEmpty()) {
    // Opening a file clears the selection, which is therefore made afterwards.
    const bool begun = window.begin(parser.positionalArguments().front(), [&] {
      wrong = window.apply_options(parser.value(pixel), {}, {}, false);
      if (!wrong.isEmpty()) QApplication::exit(fail(2, wrong));
    });
    if (unattended) {
      while (window.is_file_busy())
        QApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents);
      const auto& document = window.session().document();
      if (!begun || document.is_empty()) return fail(1, window.last_message());
      for (const plenoflame::SceneIssue& issue : document.issues())
        if (issue.is_error) return fail(1, QString::fromStdString(plenoflame::to_string(issue)));
    }
    if (!wrong.isEmpty()) return 2;
  } else if (!unattended) {
    window.begin({});
  }
  wrong = window.apply_options(parser.value(pixel), parser.value(part), parser.value(dock),
                               parser.isSet(dark));
  if (!wrong.isEmpty()) return fail(2, wrong);
  bool refocus = false;
  if (parser.isSet(depth)) {
    try {
      window.light_field_panel().set_depth(plenoflame::parse_quantity(
          parser.value(depth).toStdString(), plenoflame::Dimension::length));
    } catch (const plenoflame::Error& error) {
      return fail(2, QString("--depth: ") + error.what());
    }
    window.light_field_panel().show_tab(plenoflame::desktop::LightFieldPanel::Tab::refocus);
    refocus = true;
  }
  if (!unattended) return QApplication::exec();

  QElapsedTimer since;
  since.start();
  QTimer poll;
  int settled = 0, status = 0;
  QObject::connect(&poll, &QTimer::timeout, &window, [&] {
    auto& session = window.session();
    // Views that are on display, and can be made, are waited for.
    const bool views_missing =
        window.light_field_panel().shows_views() && !session.document().is_empty() &&
        session.document().camera().array.present && window.last_message().isEmpty() &&
        (!session.light_field().views() ||
         (refocus &&
          (!session.light_field().refocused().image || session.light_field().refocused().preview)));
    const QString& failure = session.compiler().failure();
    if (!failure.isEmpty()) {
      poll.stop();
      return QApplication::exit(fail(1, failure));
    }
    settled = window.is_settled() && !views_missing ? settled + 1 : 0;
    const bool late = since.elapsed() > 1000 * kScreenshotDeadline;
    if (settled < 6 && !late) return;
    poll.stop();
    if (late) status = fail(1, "not everything was ready in time");
    // A depth that the camera cannot refocus on: the picture would show another one.
    const bool refused =
        refocus && !session.light_field().refocused().image && !window.last_message().isEmpty();
    if (refused || !window.save_screenshot(parser.value(screenshot)))
      status = fail(1, window.last_message());
    QApplication::exit(status);
  });
  poll.start(kPollInterval);
  return QApplication::exec();
}
