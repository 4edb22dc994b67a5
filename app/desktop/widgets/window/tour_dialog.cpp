#include "widgets/window/tour_dialog.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <utility>

namespace plenoflame::desktop {

TourDialog::TourDialog(std::vector<Step> steps, QWidget* parent)
    : QDialog(parent),
      steps_(std::move(steps)),
      text_(new QLabel(this)),
      back_(new QPushButton(tr("Back"), this)),
      next_(new QPushButton(tr("Next"), this)) {
  setObjectName("tourDialog");
  setWindowTitle(tr("How a plenoptic camera works"));
  text_->setObjectName("tourText");
  text_->setWordWrap(true);
  text_->setTextFormat(Qt::RichText);
  text_->setAlignment(Qt::AlignTop);
  back_->setObjectName("tourBack");
  next_->setObjectName("tourNext");
  next_->setDefault(true);
  auto* buttons = new QHBoxLayout;
  buttons->addStretch(1);
  buttons->addWidget(back_);
  buttons->addWidget(next_);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(text_, 1);
  layout->addLayout(buttons);
  connect(back_, &QPushButton::clicked, this, [this] { go_to(step_ - 1); });
  connect(next_, &QPushButton::clicked, this, [this] {
    if (step_ + 1 < TourDialog::steps())
      go_to(step_ + 1);
    else
      accept();
  });
}

void TourDialog::go_to(int step) {
  if (step < 0 || step >= steps()) return;
  step_ = step;
  const Step& now = steps_[static_cast<std::size_t>(step)];
  text_->setText(QString("<p><b>%1 (%2)</b></p><p>%3</p>")
                     .arg(now.title, tr("%1 of %2").arg(step + 1).arg(steps()), now.text));
  back_->setEnabled(step > 0);
  next_->setText(step + 1 < steps() ? tr("Next") : tr("End"));
  now.show();
}

}  // namespace plenoflame::desktop
