#pragma once
#include <QAbstractItemModel>
#include <QStringList>
#include <memory>
#include <string>
#include <vector>

#include "model/document.h"
#include "plenoflame/scene/scene_schema.h"

namespace plenoflame::desktop {

/// The document's scene as a tree: tables, lists and values, from the one table that describes
/// scene files. Column 0 names, 1 values as text with units, 2 what is allowed.
///
/// A rejected value stays on display with its message until the user corrects or replaces it. The
/// document does not get it.
class ParameterModel : public QAbstractItemModel {
  Q_OBJECT
 public:
  enum Column { kName, kValue, kAllowed, kColumns };
  enum Role {
    kPathRole = Qt::UserRole,  ///< with indices, "flames[0].position"
    kChoicesRole,              ///< QStringList: what a choice or a truth value may be
    kMessageRole,              ///< what is wrong here, empty: nothing
    kIsErrorRole,              ///< whether that is an error, not a warning
    kListRole,                 ///< path of the list that this is, or that this is an item of
    kItemRole,                 ///< number of the item in that list, -1: the list itself
    kReasonRole,               ///< why it has no effect as the scene is; empty: it has one
    kPresetRole,               ///< PresetKind as int of a table that takes presets, otherwise -1
  };

  explicit ParameterModel(Document& document, QObject* parent = nullptr);
  ~ParameterModel() override;

  QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
  QModelIndex parent(const QModelIndex& index) const override;
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  /// False when the value is refused; its message is then at the field.
  bool setData(const QModelIndex& index, const QVariant& value, int role = Qt::EditRole) override;

  /// Sets a value; with a word that is not empty, values in a row are one step (a slider).
  bool set_value(const QModelIndex& index, const QString& text, const std::string& merge);

  /// Values that were refused and are still on display, the newest last: path, text, message.
  struct Refusal {
    QString path, text, message;
  };
  const std::vector<Refusal>& refusals() const { return refused_; }
  /// Puts the value of the scene in the place of the newest of them.
  void forget_refusal();

  /// The value that a path names, with or without a component: "flames[0].position.x" is the first
  /// component of the key flames[0].position.
  struct Place {
    const SchemaKey* key = nullptr;  ///< null: there is no such value
    std::string path;
    int component = -1;  ///< -1: the whole value
  };
  static Place place_of(const std::string& path);

  /// Index of a path; invalid when there is none. @param column of the result
  QModelIndex find(const std::string& path, int column = kName) const;

 signals:
  /// refusals() has changed.
  void refusals_changed();
  /// A value was refused. @param message as the command line says it
  void refused(const QString& path, const QString& message);

 private:
  struct Node;
  void rebuild();
  void refresh();
  void follow();
  Node* node_of(const QModelIndex& index) const;
  QString message_of(const Node& node, bool* is_error) const;
  void announce(Node& node);

  Document& document_;
  std::unique_ptr<Node> root_;
  std::vector<std::string> paths_;
  const Refusal* refusal_of(const std::string& path) const;
  std::vector<Refusal> refused_;
};

}  // namespace plenoflame::desktop
