#pragma once
#include <QObject>
#include <QString>
#include <QStringList>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/document.h"
#include "model/jobs/latest_task.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/camera/resolution.h"

namespace plenoflame::desktop {

/// The report of `plenoflame design` about a camera.
struct DesignResult {
  CameraDesign figures;
  std::vector<ResolutionPoint> resolution;
  std::vector<std::pair<std::string, std::string>> lines;  ///< label and text, in order
  QStringList warnings;
  bool complete = false;  ///< false: first-order figures alone, rays are still being traced
};
DesignResult design_result(const Scene& scene, bool traced);

/// Keeps the design of the document's camera up to date: first-order figures at once, those by rays
/// when they are there.
class DesignJob : public QObject {
  Q_OBJECT
 public:
  explicit DesignJob(Document& document, QObject* parent = nullptr);
  const std::shared_ptr<const DesignResult>& result() const { return result_; }
  bool busy() const { return task_.busy(); }

 signals:
  void result_changed();
  void failed(const QString& message);

 private:
  void request();

  Document& document_;
  std::shared_ptr<const DesignResult> result_;
  unsigned newest_ = 0;
  LatestTask task_{Urgency::work};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
