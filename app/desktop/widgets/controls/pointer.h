#pragma once
#include <QPointF>
#include <QtGlobal>

namespace plenoflame::desktop {

/// Place of the pointer on the widget [logical pixel], by the name that Qt of this version gives
/// it.
template <class Event>
QPointF pointer_place(const Event* event) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  return event->position();
#else
  return event->localPos();
#endif
}

}  // namespace plenoflame::desktop
