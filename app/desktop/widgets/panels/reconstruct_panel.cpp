#include "widgets/panels/reconstruct_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/volumes/reconstruct_request.h"
#include "widgets/controls/file_chooser.h"
#include "widgets/controls/flow_layout.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/panels/render_panel.h"
#include "widgets/panels/slices_page.h"
#include "widgets/window/beside_window.h"

namespace plenoflame::desktop {
namespace {

QComboBox* choice_of(QWidget* parent, const char* name, const QString& tip,
                     const std::vector<std::pair<QString, QString>>& entries) {
  auto* box = new QComboBox(parent);
  box->setObjectName(name);
  box->setToolTip(tip);
  for (const auto& [text, value] : entries) box->addItem(text, value);
  // Long entries must not make the panel wide.
  box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  box->setMinimumContentsLength(8);
  return box;
}

}  // namespace

ReconstructPanel::ReconstructPanel(Session& session, FileChooser& chooser, QWidget* parent)
    : QWidget(parent), session_(session), chooser_(chooser) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addLayout(make_buttons());
  layout->addWidget(make_form());
  make_result();

  const auto chosen = QOverload<int>::of(&QComboBox::currentIndexChanged);
  for (QComboBox* box : {find_, unknowns_, solver_})
    connect(box, chosen, this, &ReconstructPanel::show_choices);
  connect(strength_, &QLineEdit::textChanged, this, &ReconstructPanel::show_choices);
  connect(start_, &QPushButton::clicked, this, &ReconstructPanel::start);
  connect(stop_, &QPushButton::clicked, &job_, &ReconstructJob::stop);
  connect(save_, &QPushButton::clicked, this, &ReconstructPanel::save_requested);
  connect(beside_, &QPushButton::clicked, this, [this] {
    if (!job_.result()) return;
    if (!window_) window_ = new BesideWindow(this);
    window_->set_fields(job_.fields());
    window_->show();
    window_->raise();
  });
  connect(cameras_, &QTreeWidget::itemChanged, this, &ReconstructPanel::propose_unknowns);
  connect(&session_.document(), &Document::scene_changed, this, &ReconstructPanel::fill_cameras);
  connect(&session_.document(), &Document::image_changed, this, &ReconstructPanel::show_pictures);
  connect(&job_, &ReconstructJob::state_changed, this, &ReconstructPanel::show_job);
  connect(&job_, &ReconstructJob::progressed, this, &ReconstructPanel::show_job);
  connect(&job_, &ReconstructJob::warned, this, &ReconstructPanel::warned);
  show_choices();
  show_job();
}

ReconstructPanel::~ReconstructPanel() = default;

QLayout* ReconstructPanel::make_pictures(QWidget* page) {
  const auto button = [&](const QString& text, const char* name, const QString& tip) {
    auto* b = new QPushButton(text, page);
    b->setObjectName(name);
    b->setToolTip(tip);
    return b;
  };
  auto* file = button(tr("Picture file..."), "reconstructFile",
                      tr("Take the chosen camera's picture from a raw light field (.exr)"));
  own_ = button(tr("Own picture"), "reconstructOwn",
                tr("The picture in the window again, or one that is rendered of the scene"));
  auto* scene = button(tr("Add scene..."), "reconstructScene",
                       tr("Cameras of another scene file (.toml) as well"));
  connect(file, &QPushButton::clicked, this, &ReconstructPanel::choose_file);
  connect(scene, &QPushButton::clicked, this, &ReconstructPanel::choose_scene);
  connect(own_, &QPushButton::clicked, this,
          [this] { set_picture(cameras_->indexOfTopLevelItem(cameras_->currentItem()), {}); });
  auto* pictures = new FlowLayout;
  pictures->setContentsMargins(0, 0, 0, 0);
  for (QPushButton* b : {file, own_, scene}) pictures->addWidget(b);
  return pictures;
}

void ReconstructPanel::make_choices(QWidget* page) {
  find_ = choice_of(page, "reconstructFind", tr("The fields that are looked for"),
                    {{tr("Emission"), "emission"},
                     {tr("Temperature"), "temperature"},
                     {tr("Temperature and absorption"), "both"}});
  unknowns_ = choice_of(page, "reconstructUnknowns", tr("The numbers that are solved for"),
                        {{tr("Voxels"), "voxels"},
                         {tr("Rings (round flame)"), "rings"},
                         {tr("Ellipsoidal layers"), "layers"}});
  why_ = new QLabel(page);
  why_->setObjectName("reconstructWhy");
  why_->setWordWrap(true);
  connect(unknowns_, QOverload<int>::of(&QComboBox::activated), this,
          [this] { unknowns_chosen_ = true; });
  const auto line = [&](const char* name, const QString& text, const QString& tip) {
    auto* edit = new QLineEdit(text, page);
    edit->setObjectName(name);
    edit->setToolTip(tip);
    return edit;
  };
  grid_ = line("reconstructGrid", "", "");
  centre_ = line("reconstructCentre", "",
                 tr("Middle of the grid in the world, such as \"1 m, 0 m, 0 m\""));
  size_ = line("reconstructSize", "", tr("Sides of the grid, such as \"60 mm, 60 mm, 90 mm\""));
  for (QLineEdit* edit : {centre_, size_})
    edit->setPlaceholderText(tr("of the scene's flames, or by the pictures"));
  rings_axis_ =
      line("reconstructRingsAxis", "",
           tr("Direction of the rings' axis, such as \"0 m, 0 m, 1 m\"; \"fit\": place and "
              "direction by the pictures"));
  rings_axis_->setPlaceholderText(tr("upwards"));
  absorption_ = choice_of(page, "reconstructAbsorption",
                          tr("What is known of the absorption; a number with a unit, such as "
                             "\"20 1/m\", can be typed"),
                          {{tr("that of the scene"), "scene"}, {tr("none"), "none"}});
  absorption_->setEditable(true);
  channel_ = choice_of(page, "reconstructChannel",
                       tr("Channel of the pictures; for temperature and absorption two or more, "
                          "such as 650nm,850nm, can be typed"),
                       {});
  channel_->setEditable(true);
  ratios_ = line("reconstructRatios", "",
                 tr("Absorption of each channel over that of the first, where it is known"));
  ratios_->setPlaceholderText(tr("as of soot"));
  solver_ = choice_of(page, "reconstructSolver", tr("How it is solved"), {});
  for (const std::string& name : reconstruction_solvers())
    solver_->addItem(QString::fromStdString(name), QString::fromStdString(name));
  solver_->setCurrentIndex(solver_->findData("fista"));
  strength_ = line("reconstructStrength", "",
                   tr("Strength of the penalty, which keeps noise out of the result, relative to "
                      "the pictures' information"));
  strength_->setPlaceholderText(tr("from the pictures"));
  noise_ = line("reconstructNoise", QString::number(ReconstructRequest().noise),
                tr("Standard deviation that is added to each pixel's own, as a share of the "
                   "largest value: for pictures that state none"));
  rays_ = line("reconstructRays", "16", tr("Rays of each row of the problem"));
  bin_ = line("reconstructBin", "1", tr("Pixels along the side of a block that makes one row"));
  iterations_ = line("reconstructIterations", "300", tr("Iterations at most"));
  behind_dark_ = new QCheckBox(tr("Also behind dark pixels"), page);
  behind_dark_->setObjectName("reconstructAllVoxels");
  behind_dark_->setToolTip(
      tr("Solve also for what lies behind dark pixels, which is taken for empty otherwise"));
}

QWidget* ReconstructPanel::make_form() {
  auto* page = new QWidget(this);
  cameras_ = new QTreeWidget(page);
  cameras_->setObjectName("reconstructCameras");
  cameras_->setHeaderLabels({tr("Camera"), tr("Its picture")});
  cameras_->setRootIsDecorated(false);
  cameras_->setMinimumHeight(5 * fontMetrics().height());
  cameras_->setMaximumHeight(9 * fontMetrics().height());
  cameras_->setToolTip(tr("Tick the cameras whose pictures are used"));
  make_choices(page);
  auto* form = new QFormLayout;
  form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
  form->addRow(tr("Find"), find_);
  form->addRow(tr("Unknowns"), unknowns_);
  form->addRow(why_);
  form->addRow(tr("Grid"), grid_);
  form->addRow(tr("Centre"), centre_);
  form->addRow(tr("Size"), size_);
  form->addRow(tr("Axis"), rings_axis_);
  form->addRow(tr("Absorption"), absorption_);
  form->addRow(tr("Channel"), channel_);
  form->addRow(tr("Ratios"), ratios_);
  form->addRow(tr("Solver"), solver_);
  form->addRow(tr("Strength"), strength_);
  form->addRow(tr("Noise"), noise_);
  form->addRow(tr("Rays"), rays_);
  form->addRow(tr("Bin"), bin_);
  form->addRow(tr("Iterations"), iterations_);
  form->addRow(behind_dark_);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(cameras_);
  layout->addLayout(make_pictures(page));
  layout->addLayout(form);
  layout->addStretch(1);
  return page;
}

QLayout* ReconstructPanel::make_buttons() {
  const auto button = [&](const QString& text, const char* name, const QString& tip) {
    auto* b = new QPushButton(text, this);
    b->setObjectName(name);
    b->setToolTip(tip);
    return b;
  };
  start_ = button(tr("Reconstruct"), "reconstructStart", tr("The flame from these pictures"));
  stop_ = button(tr("Stop"), "reconstructStop", tr("End; what was reached is kept"));
  save_ = button(tr("Save..."), "reconstructSave",
                 tr("Everything that was found, as grids of an OpenVDB file"));
  beside_ = button(tr("3-D"), "reconstructBeside",
                   tr("What was found beside the flame of the scene, in three dimensions"));
  auto* buttons = new FlowLayout;
  buttons->setContentsMargins(0, 0, 0, 0);
  for (QPushButton* b : {start_, stop_, save_, beside_}) buttons->addWidget(b);
  state_ = new QLabel(this);
  state_->setObjectName("reconstructState");
  state_->setWordWrap(true);
  state_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  auto* column = new QVBoxLayout;
  column->addLayout(buttons);
  column->addWidget(state_);
  return column;
}

void ReconstructPanel::make_result() {
  auto* page = result_ = new QWidget;
  curve_ = new PlotWidget(page);
  curve_->setObjectName("reconstructCurve");
  curve_->set_axes(tr("iteration"), tr("chi^2 per row"), false, true);
  curve_->set_empty_text(tr("How well the pictures are explained appears here."));
  slices_ = new SlicesPage(page);
  report_ = new QPlainTextEdit(page);
  report_->setObjectName("reconstructReport");
  report_->setReadOnly(true);
  report_->setPlaceholderText(tr("The report of `plenoflame reconstruct` appears here."));
  report_->setLineWrapMode(QPlainTextEdit::WidgetWidth);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(slices_, 5);
  auto* below = new QHBoxLayout;
  below->addWidget(curve_, 1);
  below->addWidget(report_, 1);
  layout->addLayout(below, 2);
}

void ReconstructPanel::add_row(Row row, bool taken) {
  const QSignalBlocker quiet(cameras_);
  row.item = new QTreeWidgetItem(cameras_);
  row.item->setText(0, row.camera.empty() ? tr("camera") : QString::fromStdString(row.camera));
  row.item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
  row.item->setCheckState(0, taken ? Qt::Checked : Qt::Unchecked);
  rows_.push_back(std::move(row));
}

void ReconstructPanel::fill_cameras() {
  const Document& document = session_.document();
  std::vector<Row> before = std::exchange(rows_, {});
  std::vector<bool> taken;
  for (const Row& row : before) taken.push_back(row.item->checkState(0) == Qt::Checked);
  cameras_->clear();
  const bool usable = !document.is_empty() && document.is_valid();
  if (usable) {
    const Scene& scene = document.scene();
    std::vector<std::string> names = camera_names(scene);
    if (scene.cameras.empty()) names = {std::string()};
    for (const std::string& name : names) {
      Row row;
      row.scene = for_camera(SceneDocument{scene, document.positions()}, name);
      row.camera = name;
      row.of_document = true;
      bool is_taken = true;
      for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i].of_document && before[i].camera == name) {
          row.file = before[i].file;
          is_taken = taken[i];
        }
      add_row(std::move(row), is_taken);
    }
    const QSignalBlocker quiet(channel_);
    const QString typed = channel_->currentText();
    const bool is_typed = channel_->count() > 0 && channel_->findText(typed) < 0;
    const QString channel = channel_->currentData().toString();
    channel_->clear();
    channel_->addItem(QString(), QString());  // show_choices() says what that is
    for (const ChannelSpec& c : scene.channels)
      channel_->addItem(QString::fromStdString(c.name), QString::fromStdString(c.name));
    channel_->setCurrentIndex(std::max(0, channel_->findData(channel)));
    if (is_typed) channel_->setEditText(typed);
    show_choices();
  }
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!before[i].of_document) add_row(std::move(before[i]), taken[i]);
  if (cameras_->topLevelItemCount() > 0) cameras_->setCurrentItem(cameras_->topLevelItem(0));
  show_pictures();
}

std::shared_ptr<const LightField> ReconstructPanel::picture_of(const Row& row) const {
  const Document& document = session_.document();
  const bool shown = row.of_document && row.file.isEmpty() &&
                     row.camera == document.camera_name() && document.image_is_current();
  return shown && document.image()->complete ? document.image() : nullptr;
}

void ReconstructPanel::show_pictures() {
  for (const Row& row : rows_) {
    row.item->setText(1, !row.file.isEmpty() ? QFileInfo(row.file).fileName()
                         : picture_of(row)   ? tr("in the window")
                                             : tr("will be rendered"));
    row.item->setToolTip(1, row.file);
  }
  start_->setEnabled(!rows_.empty() && job_.state() != ReconstructJob::State::running);
  propose_unknowns();
}

void ReconstructPanel::set_picture(int row, const QString& file) {
  if (row < 0 || row >= static_cast<int>(rows_.size())) return;
  rows_[static_cast<std::size_t>(row)].file = file;
  show_pictures();
}

void ReconstructPanel::choose_file() {
  const int row = cameras_->indexOfTopLevelItem(cameras_->currentItem());
  if (row < 0) return;
  const QString file =
      chooser_.file_to_read(this, tr("Picture of the camera"), tr("Raw light fields (*.exr)"));
  if (!file.isEmpty()) set_picture(row, file);
}

void ReconstructPanel::choose_scene() {
  const QString file =
      chooser_.file_to_read(this, tr("Scene of further cameras"), tr("Scenes (*.toml)"));
  if (file.isEmpty()) return;
  try {
    add_scene(file);
  } catch (const std::exception& error) {
    emit failed(QString::fromUtf8(error.what()));
  }
}

void ReconstructPanel::add_scene(const QString& file) {
  const SceneDocument document = read_scene_file(file.toStdString());
  std::vector<std::string> names = camera_names(document.scene);
  if (document.scene.cameras.empty()) names = {std::string()};
  for (const std::string& name : names) {
    Row row;
    row.scene = for_camera(document, name);
    row.camera = QFileInfo(file).completeBaseName().toStdString() +
                 (name.empty() ? std::string() : ", " + name);
    add_row(std::move(row), true);
  }
  show_pictures();
}

/// Rings for one camera and voxels for several, until the user chooses.
void ReconstructPanel::propose_unknowns() {
  const auto taken = std::ranges::count_if(
      rows_, [](const Row& row) { return row.item->checkState(0) == Qt::Checked; });
  if (!unknowns_chosen_ && taken > 0)
    unknowns_->setCurrentIndex(unknowns_->findData(taken == 1 ? "rings" : "voxels"));
  const bool voxels = unknowns_->currentData().toString() == "voxels";
  why_->setText(voxels ? tr("One camera cannot tell the depth of voxels.")
                       : tr("One camera cannot tell the depth: the flame is taken to be round."));
  why_->setVisible(taken == 1 && unknowns_->currentData().toString() != "layers");
}

void ReconstructPanel::show_choices() {
  propose_unknowns();
  const QString unknowns = unknowns_->currentData().toString(),
                find = find_->currentData().toString(), solver = solver_->currentData().toString();
  grid_->setPlaceholderText(unknowns == "voxels"  ? tr("32 along the longest side")
                            : unknowns == "rings" ? tr("40,80: rings, heights")
                                                  : tr("10 layers"));
  grid_->setToolTip(unknowns == "voxels"  ? tr("Voxels along the longest side, or NX,NY,NZ")
                    : unknowns == "rings" ? tr("Rings and heights, N,M")
                                          : tr("The number of layers"));
  rings_axis_->setEnabled(unknowns == "rings");
  absorption_->setEnabled(find != "both");
  ratios_->setEnabled(find == "both");
  if (channel_->count() > 0) {
    // A new name of an entry would replace what was typed.
    const QString typed = channel_->currentText();
    const bool is_typed = channel_->findText(typed) < 0;
    channel_->setItemText(0, find == "both" ? tr("the first two") : tr("the first"));
    if (is_typed) channel_->setEditText(typed);
  }
  solver_->setEnabled(find == "emission");
  // A solver without penalty has no strength.
  strength_->setEnabled(find != "emission" ||
                        QStringList{"fista", "nnls", "cgls", "lsqr"}.contains(solver));
}

void ReconstructPanel::start() {
  std::vector<ReconstructSource> sources;
  for (const Row& row : rows_) {
    if (row.item->checkState(0) != Qt::Checked) continue;
    ReconstructSource source;
    source.scene = row.scene;
    source.time = row.of_document ? session_.document().time() : std::nullopt;
    source.camera = row.camera;
    source.file = row.file.toStdString();
    source.picture = picture_of(row);
    source.what = row.file.isEmpty() ? tr("the picture of %1").arg(row.item->text(0)).toStdString()
                                     : source.file;
    sources.push_back(std::move(source));
  }
  const std::string find = find_->currentData().toString().toStdString();
  ReconstructJob::Options options{{"find", find},
                                  {"unknowns", unknowns_->currentData().toString().toStdString()}};
  const auto text = [&](const char* name, const QString& value) {
    if (!value.trimmed().isEmpty()) options.emplace_back(name, value.trimmed().toStdString());
  };
  const auto chosen = [&](const char* name, const QComboBox* box) {
    if (!box->isEnabled()) return;
    const int index = box->findText(box->currentText());  // something else may have been typed
    text(name, index < 0 ? box->currentText() : box->itemData(index).toString());
  };
  const auto typed = [&](const char* name, const QLineEdit* edit) {
    if (edit->isEnabled()) text(name, edit->text());
  };
  typed("grid", grid_);
  typed("center", centre_);
  typed("size", size_);
  typed("axis", rings_axis_);
  chosen("absorption", absorption_);
  chosen("channel", channel_);
  typed("absorption-ratios", ratios_);
  chosen("solver", solver_);
  typed("strength", strength_);
  typed("noise", noise_);
  typed("rays", rays_);
  typed("bin", bin_);
  typed("iterations", iterations_);
  options.emplace_back("all-voxels", behind_dark_->isChecked() ? "true" : "false");
  const bool has_flame = !sources.empty() && !sources.front().scene.scene.flames.empty();
  options.emplace_back("truth", has_flame ? "true" : "false");
  emit began();
  job_.start(std::move(sources), options);
}

void ReconstructPanel::show_job() {
  const bool running = job_.state() == ReconstructJob::State::running;
  start_->setEnabled(!rows_.empty() && !running);
  const bool going_on = running && !job_.stopping();
  stop_->setEnabled(going_on);
  save_->setEnabled(job_.result() != nullptr);
  beside_->setEnabled(job_.result() != nullptr);
  const bool shared = going_on && job_.share() > 0;
  state_->setText(!shared ? job_.text()
                          : tr("%1 %, %2 to go: %3")
                                .arg(100 * job_.share(), 0, 'f', 0)
                                .arg(duration_text(job_.remaining_seconds()), job_.text()));
  PlotWidget::Series trials, solution;
  trials.name = tr("strengths that are tried");
  trials.colour = QColor(150, 150, 150);
  trials.points = job_.trials();
  solution.name = tr("solution");
  solution.colour = QColor(213, 94, 0);
  solution.points = job_.solution();
  curve_->set_series({trials, solution});
  if (report_->toPlainText() != job_.report()) report_->setPlainText(job_.report());
  slices_->set_fields(job_.fields(), job_.result() != nullptr);
}

}  // namespace plenoflame::desktop
