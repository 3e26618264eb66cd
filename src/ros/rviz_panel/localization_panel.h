// A panel of rviz: status and accuracy of the localizer, and buttons for its services.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>
#include <rviz/panel.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros/rviz_panel/panel_content.h"
#include "ros/util/worker_thread.h"

class QBoxLayout;
class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;

namespace racecar_mcl {

/// Messages arrive on the thread of the widgets, as rviz processes the global callback queue there.
/// Services are called on a thread of the panel's own.
class LocalizationPanel : public rviz::Panel {
 public:
  explicit LocalizationPanel(QWidget* parent = nullptr);
  ~LocalizationPanel() override;

  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 private:
  struct Received {
    diagnostic_msgs::DiagnosticStatus status;
    ros::WallTime time;
  };
  /// Calls a service by its name; returns its answer, or why there is none.
  using Call = std::function<std::string(const std::string& service)>;

  /// On the panel's own thread. An empty text: the call succeeded.
  template <typename Service>
  std::string callOrExplain(const std::string& name, Service* service);
  std::string callEmpty(const std::string& name);
  std::string callTrigger(const std::string& name);

  void addValues(QGridLayout* grid);
  /// `service` is relative to the node's namespace, with `~` to the node.
  void addButton(const char* text, const char* service, const char* explanation, const Call& call);
  void addNodeName(QBoxLayout* layout);
  /// Follows the node of this name, by default "/localization".
  void setNode(const std::string& node);
  void onStatus(const diagnostic_msgs::DiagnosticStatus& message);
  void onDiagnostics(const diagnostic_msgs::DiagnosticArray& message);
  void callService(const std::string& service, const Call& call);
  void showAnswer(const std::string& text);
  void refresh();

  QLabel* state_;
  QLabel* reason_;
  QLabel* answer_;
  QLineEdit* node_name_;
  std::vector<std::pair<QLabel*, std::string PanelContent::*>> values_;
  std::vector<QPushButton*> buttons_;

  std::string node_;
  std::optional<Received> status_, diagnostics_;
  ros::NodeHandle handle_;
  ros::Subscriber status_subscriber_, diagnostics_subscriber_;

  std::mutex client_mutex_;                   ///< guards the next one
  std::optional<ros::ServiceClient> client_;  ///< of the call that waits for its answer
  std::condition_variable call_ended_;
  std::atomic<bool> is_closing_{false};
  WorkerThread caller_;  ///< last, so that it ends before what it uses
};

}  // namespace racecar_mcl
