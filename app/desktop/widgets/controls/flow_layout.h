#pragma once
#include <QLayout>
#include <vector>

namespace plenoflame::desktop {

/// Widgets side by side on as many lines as they need, so that a narrow panel hides none of them.
/// Widgets that may grow sideways share the room that is left in their line.
class FlowLayout : public QLayout {
 public:
  explicit FlowLayout(QWidget* parent = nullptr);
  ~FlowLayout() override;

  void addItem(QLayoutItem* item) override;
  int count() const override { return static_cast<int>(items_.size()); }
  QLayoutItem* itemAt(int index) const override;
  QLayoutItem* takeAt(int index) override;
  bool hasHeightForWidth() const override { return true; }
  int heightForWidth(int width) const override { return arrange({0, 0, width, 0}, false); }
  QSize sizeHint() const override { return minimumSize(); }
  QSize minimumSize() const override;
  Qt::Orientations expandingDirections() const override { return {}; }
  void setGeometry(const QRect& area) override;

 private:
  /// @param place false: only asks how high it would be
  int arrange(const QRect& area, bool place) const;
  std::vector<QLayoutItem*> items_;
};

}  // namespace plenoflame::desktop
