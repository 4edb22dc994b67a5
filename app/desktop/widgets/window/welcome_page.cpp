#include "widgets/window/welcome_page.h"

#include <QCommandLinkButton>
#include <QFileInfo>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QIcon>
#include <QKeyEvent>
#include <QLabel>
#include <QListWidget>
#include <QPainter>
#include <QPushButton>
#include <QScrollArea>
#include <QVBoxLayout>

namespace plenoflame::desktop {
namespace {

constexpr int kThumbnail = 48;  ///< [logical pixel]
constexpr int kColumns = 2;     ///< of examples

/// An example to open: Return does what a click does, and the focus is seen.
class ExampleButton : public QCommandLinkButton {
 public:
  using QCommandLinkButton::QCommandLinkButton;

 protected:
  void keyPressEvent(QKeyEvent* event) override {
    if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) return click();
    QCommandLinkButton::keyPressEvent(event);
  }
  void paintEvent(QPaintEvent* event) override {
    QCommandLinkButton::paintEvent(event);
    if (!hasFocus()) return;
    QPainter painter(this);
    painter.setPen(QPen(palette().color(QPalette::Highlight), 3));
    painter.drawRect(rect().adjusted(1, 1, -2, -2));
  }
};

}  // namespace

WelcomePage::WelcomePage(QWidget* parent) : QWidget(parent), recent_(new QListWidget(this)) {
  setObjectName("welcomePage");
  setAutoFillBackground(true);
  auto* icon = new QLabel(this);
  icon->setPixmap(QIcon(":/plenoflame-desktop.svg").pixmap(72, 72));
  auto* title = new QLabel(tr("<span style='font-size:22pt'>Plenoflame</span><br>"
                              "What a light-field camera sees of a flame"),
                           this);
  auto* head = new QHBoxLayout;
  head->addWidget(icon);
  head->addWidget(title, 1);
  auto* left = new QVBoxLayout;
  auto* examples = new QWidget(this);
  auto* grid = new QGridLayout(examples);
  grid->setContentsMargins(0, 0, 0, 0);
  const auto example = [&](const char* name, const QString& text, const QString& about) {
    auto* button = new ExampleButton(text, about, examples);
    button->setObjectName(QString("example-") + name);
    button->setIcon(QIcon(QString(":/thumb/%1.png").arg(name)));
    button->setIconSize(QSize(kThumbnail, kThumbnail));
    connect(button, &QCommandLinkButton::clicked, this,
            [this, name] { emit example_chosen(QString(name)); });
    grid->addWidget(button, grid->count() / kColumns, grid->count() % kColumns);
  };
  example("paper-flame-1m", tr("The paper's flame"),
          tr("A layered flame 1 m before a multi-focus plenoptic camera of 3000 x 3000 pixels"));
  example("paper-flame-0.3m", tr("The paper's flame, near"),
          tr("This flame at 0.3 m fills the picture"));
  example("paper-previous-60x60", tr("An unfocused camera"),
          tr("60 x 60 square microlenses of 10 x 10 pixels: the simplest one for views"));
  example("lenslets-30", tr("A small camera"),
          tr("30 microlenses across, rendered within a second"));
  example("square-lenses", tr("Square microlenses"), tr("The small camera without gaps"));
  example("three-cameras", tr("Three cameras"),
          tr("Two plenoptic cameras at right angles, a conventional one between"));
  example("ring-of-six", tr("Six cameras"), tr("Around a flame, for tomography"));
  example("three-filters", tr("Three colours in one picture"),
          tr("A filter before each third of the main lens, for pyrometry"));
  example("candle", tr("A candle"), tr("A flame of voxels before microlenses of three types"));
  example("candle-colours", tr("A candle in colour"),
          tr("Two narrow bands for its temperature, three for its picture"));
  example("candle-blue", tr("The blue base of a candle"),
          tr("Glowing soot, and the light of radicals"));
  example("flickering", tr("A candle that flickers"), tr("A series of three frames"));
  example("quartz-tube", tr("A candle in a tube of quartz"), tr("Behind a window as well"));
  example("burner", tr("A candle on a burner"), tr("Its light on a metal tube and a wall"));
  example("tutorial", tr("The tutorial's candle"),
          tr("Micro-images that touch and do not overlap"));
  example("candle-r29", tr("A candle before an R29"), tr("With the noise of a sensor"));
  example("reconstruct-front", tr("For a reconstruction, from the front"),
          tr("One of two cameras that look at a candle at right angles"));
  example("reconstruct-side", tr("For a reconstruction, from the side"), tr("The other one"));
  example("reconstruct-two-colours", tr("For a reconstruction, of two colours"),
          tr("Their ratio tells the temperature"));
  example("smoke", tr("Smoke"), tr("A flame lights a puff before a chequered wall"));
  example("calibration-plate", tr("Calibration boards"),
          tr("Checkerboards and dots at four poses"));
  example("paper-objects-5m", tr("The paper's objects"),
          tr("Ball, cylinder and cone through its multi-focus camera"));
  example("paper-objects-5m-60x60", tr("The same, unfocused"),
          tr("Through the camera of 60 x 60 microlenses"));
  example("paper-objects-5m-no-array", tr("The same, ordinary"),
          tr("Through the camera without its array"));
  example("paper-objects-r29", tr("Objects before an R29"),
          tr("28.8 million pixels: rendering takes minutes"));
  grid->setRowStretch(grid->rowCount(), 1);
  auto* scroll = new QScrollArea(this);
  scroll->setObjectName("welcomeExamples");
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setWidgetResizable(true);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setWidget(examples);
  left->addWidget(scroll, 1);
  auto* open = new QPushButton(tr("Open a file..."), this);
  open->setObjectName("welcomeOpen");
  open->setAutoDefault(true);
  open->setToolTip(
      tr("A scene (.toml), a flame (.vdb) or a raw light field (.exr); or drop it on this window"));
  left->addWidget(open, 0, Qt::AlignLeft);
  back_ = new QPushButton(tr("Back to the open scene"), this);
  back_->setObjectName("welcomeBack");
  back_->setToolTip(tr("What was open before is still there"));
  back_->hide();
  left->addWidget(back_, 0, Qt::AlignLeft);
  auto* right = new QVBoxLayout;
  right->addWidget(new QLabel(tr("Recent files"), this));
  recent_->setObjectName("recentFiles");
  right->addWidget(recent_, 1);
  right->addWidget(new QLabel(tr("Then: click a pixel to see its rays in all views,\n"
                                 "change any value in the tree on the left,\n"
                                 "drag depth and aperture in the light-field panel.\n"
                                 "F1 opens the documentation."),
                              this));
  auto* columns = new QHBoxLayout;
  columns->addLayout(left, 3);
  columns->addSpacing(24);
  columns->addLayout(right, 2);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(48, 12, 48, 12);
  layout->addLayout(head);
  layout->addSpacing(18);
  layout->addLayout(columns, 1);
  connect(open, &QPushButton::clicked, this, &WelcomePage::open_requested);
  connect(back_, &QPushButton::clicked, this, &WelcomePage::back_requested);
  connect(recent_, &QListWidget::itemActivated, this,
          [this](QListWidgetItem* item) { emit file_chosen(item->data(Qt::UserRole).toString()); });
}

void WelcomePage::set_open(bool open) {
  back_->setVisible(open);
}

void WelcomePage::set_recent(const QStringList& files) {
  recent_->clear();
  for (const QString& file : files) {
    const QFileInfo info(file);
    auto* item = new QListWidgetItem(info.fileName() + "\n    " + info.absolutePath(), recent_);
    item->setData(Qt::UserRole, file);
  }
  if (!files.isEmpty()) return;
  auto* const none = new QListWidgetItem(tr("Files that you open will be listed here."), recent_);
  none->setFlags(Qt::NoItemFlags);
}

}  // namespace plenoflame::desktop
