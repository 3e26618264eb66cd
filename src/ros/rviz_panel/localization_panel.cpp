#include "ros/rviz_panel/localization_panel.h"

#include <ros/names.h>
#include <ros/service.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>

#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QTimer>
#include <QVBoxLayout>
#include <chrono>
#include <pluginlib/class_list_macros.hpp>

#include "ros/localization/diagnostics.h"

namespace racecar_mcl {
namespace {

constexpr char kDefaultNode[] = "/localization";
// Older messages are those of a node that has ended. The status arrives at 10 Hz.
constexpr double kMaxStatusAge = 2.0;       // s
constexpr double kMaxDiagnosticsAge = 5.0;  // s
constexpr int kRefreshPeriod = 500;         // ms
constexpr auto kShutdownPeriod = std::chrono::milliseconds(50);

/// A label for this many lines of text, which can be copied. The text may be longer than the panel
/// is wide.
QLabel* makeText(const char* name, int lines = 1) {
  auto* label = new QLabel;
  label->setObjectName(name);
  label->setTextFormat(Qt::PlainText);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label->setWordWrap(lines > 1);
  label->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  // Else the minimum is the height of the text, in the font that it has by then.
  if (lines > 1) label->setMinimumHeight(lines * label->fontMetrics().lineSpacing());
  return label;
}

template <typename Message>
bool isRecent(const std::optional<Message>& message, double max_age) {
  return message && (ros::WallTime::now() - message->time).toSec() < max_age;
}

}  // namespace

LocalizationPanel::LocalizationPanel(QWidget* parent)
    : rviz::Panel(parent),
      state_(makeText("state")),
      reason_(makeText("reason", 2)),
      answer_(makeText("answer", 2)),
      node_name_(new QLineEdit),
      caller_([this](const std::string& what) { showAnswer("failed: " + what); }) {
  auto* layout = new QVBoxLayout(this);
  state_->setAlignment(Qt::AlignCenter);
  layout->addWidget(state_);
  layout->addWidget(reason_);
  auto* grid = new QGridLayout;
  grid->setColumnStretch(1, 1);
  layout->addLayout(grid);
  addValues(grid);
  const Call trigger = [this](const std::string& name) { return callTrigger(name); };
  addButton("Search the map", "global_localization",
            "Global localization: the pose is searched on the whole map",
            [this](const std::string& name) { return callEmpty(name); });
  addButton("Save pose", "~save_pose",
            "Writes the pose to last_pose_file, from which the next start continues", trigger);
  addButton("Reload parameters", "~reload_parameters",
            "Reads the parameters of the node again and applies them", trigger);
  layout->addWidget(answer_);
  layout->addStretch();
  addNodeName(layout);
  setNode(kDefaultNode);
  diagnostics_subscriber_ =
      handle_.subscribe("/diagnostics", 10, &LocalizationPanel::onDiagnostics, this);
  auto* timer = new QTimer(this);
  connect(timer, &QTimer::timeout, this, [this] { refresh(); });
  timer->start(kRefreshPeriod);
}

LocalizationPanel::~LocalizationPanel() {
  is_closing_ = true;
  // Ends a call that waits for its answer, for which the thread would wait. A call that has not
  // connected yet is not ended.
  std::unique_lock<std::mutex> lock(client_mutex_);
  while (client_) {
    client_->shutdown();
    call_ended_.wait_for(lock, kShutdownPeriod);
  }
}

template <typename Service>
std::string LocalizationPanel::callOrExplain(const std::string& name, Service* service) {
  if (!ros::service::exists(name, false)) return "there is no service " + name;
  ros::ServiceClient client = handle_.serviceClient<Service>(name, true);
  const auto set_client = [this](const std::optional<ros::ServiceClient>& newest) {
    const std::lock_guard<std::mutex> lock(client_mutex_);
    client_ = newest;
  };
  set_client(client);
  const bool is_answered = !is_closing_ && client.call(*service);
  set_client({});
  call_ended_.notify_one();
  return is_answered ? "" : "the call of " + name + " failed";
}

std::string LocalizationPanel::callEmpty(const std::string& name) {
  std_srvs::Empty service;
  const std::string problem = callOrExplain(name, &service);
  return problem.empty() ? "done" : problem;
}

std::string LocalizationPanel::callTrigger(const std::string& name) {
  std_srvs::Trigger service;
  std::string problem = callOrExplain(name, &service);
  if (!problem.empty()) return problem;
  return (service.response.success ? "done: " : "refused: ") + service.response.message;
}

void LocalizationPanel::addValues(QGridLayout* grid) {
  struct Row {
    const char* title;
    const char* name;
    std::string PanelContent::*value;
    const char* explanation;
  };
  const Row rows[] = {
      {"Scan explained", "explained", &PanelContent::explained,
       "Share of the scan that agrees with the map at the estimated pose"},
      {"Position bound", "position_bound", &PanelContent::position_bound,
       "Protection level: a bound on the error"},
      {"Heading bound", "heading_bound", &PanelContent::heading_bound,
       "Protection level: a bound on the error"},
      {"Standard deviation", "sigma", &PanelContent::sigma, "Of position and heading"},
      {"Particles", "particles", &PanelContent::particles, "Of the last update"},
      {"Latency", "latency", &PanelContent::latency,
       "From the arrival of a scan to its tf: median, and the 99 % quantile"}};
  for (const Row& row : rows) {
    QLabel* value = makeText(row.name);
    values_.emplace_back(value, row.value);
    auto* title = new QLabel(row.title);
    title->setToolTip(row.explanation);
    value->setToolTip(row.explanation);
    grid->addWidget(title, grid->rowCount(), 0);
    grid->addWidget(value, grid->rowCount() - 1, 1);
  }
}

void LocalizationPanel::addButton(const char* text, const char* service, const char* explanation,
                                  const Call& call) {
  auto* button = new QPushButton(text);
  button->setObjectName(service);
  button->setToolTip(explanation);
  connect(button, &QPushButton::clicked, this,
          [this, service = std::string(service), call] { callService(service, call); });
  layout()->addWidget(button);
  buttons_.push_back(button);
}

void LocalizationPanel::addNodeName(QBoxLayout* layout) {
  node_name_->setObjectName("node");
  node_name_->setFocusPolicy(Qt::ClickFocus);  // disabled buttons pass the focus on
  node_name_->setToolTip("Name of the localizer's node; its topics are in the same namespace");
  connect(node_name_, &QLineEdit::editingFinished, this, [this] {
    if (node_name_->text().toStdString() == node_) return;
    setNode(node_name_->text().toStdString());
    Q_EMIT configChanged();
  });
  auto* line = new QHBoxLayout;
  line->addWidget(new QLabel("Node"));
  line->addWidget(node_name_);
  layout->addLayout(line);
}

void LocalizationPanel::setNode(const std::string& node) {
  std::string problem;
  if (node.empty() || !ros::names::validate(node, problem)) {
    answer_->setText(QString::fromStdString("'" + node + "' is no name of a node: " + problem));
    node_name_->setText(QString::fromStdString(node_));
    return;
  }
  node_ = ros::names::resolve(node);
  node_name_->setText(QString::fromStdString(node_));
  status_.reset();
  diagnostics_.reset();
  const std::string parent = ros::names::parentNamespace(node_);
  status_subscriber_ = handle_.subscribe(ros::names::append(parent, "pf/status"), 1,
                                         &LocalizationPanel::onStatus, this);
  refresh();
}

void LocalizationPanel::load(const rviz::Config& config) {
  Panel::load(config);
  QString node;
  if (config.mapGetString("Node", &node)) setNode(node.toStdString());
}

void LocalizationPanel::save(rviz::Config config) const {
  Panel::save(config);
  config.mapSetValue("Node", QString::fromStdString(node_));
}

void LocalizationPanel::onStatus(const diagnostic_msgs::DiagnosticStatus& message) {
  status_ = Received{message, ros::WallTime::now()};
  refresh();
}

void LocalizationPanel::onDiagnostics(const diagnostic_msgs::DiagnosticArray& message) {
  const std::string name = diagnosticsName(node_);
  for (const auto& status : message.status) {
    if (status.name == name) {
      diagnostics_ = Received{status, ros::WallTime::now()};
    }
  }
}

void LocalizationPanel::callService(const std::string& service, const Call& call) {
  const std::string name = service[0] == '~'
                               ? ros::names::append(node_, service.substr(1))
                               : ros::names::append(ros::names::parentNamespace(node_), service);
  for (QPushButton* button : buttons_) button->setEnabled(false);
  answer_->setText("waiting for an answer");
  caller_.post([this, name, call] { showAnswer(call(name)); });
}

void LocalizationPanel::showAnswer(const std::string& text) {
  const auto show = [this, text] {
    for (QPushButton* button : buttons_) button->setEnabled(true);
    answer_->setText(QString::fromStdString(text));
  };
  QMetaObject::invokeMethod(this, show, Qt::QueuedConnection);
}

void LocalizationPanel::refresh() {
  std::optional<diagnostic_msgs::DiagnosticStatus> status, diagnostics;
  if (isRecent(status_, kMaxStatusAge)) status = status_->status;
  if (isRecent(diagnostics_, kMaxDiagnosticsAge)) diagnostics = diagnostics_->status;
  const PanelContent content = panelContent(status, diagnostics);
  state_->setText(QString::fromStdString(content.state));
  const QString style = QString::fromStdString(
      "color: white; background: " + content.colour +
      "; font-size: 16pt; font-weight: bold; padding: 6px; border-radius: 4px;");
  if (style != state_->styleSheet()) state_->setStyleSheet(style);  // Qt lays all out anew
  reason_->setText(QString::fromStdString(content.reason));
  for (const auto& [label, value] : values_) {
    label->setText(QString::fromStdString(content.*value));
  }
}

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::LocalizationPanel, rviz::Panel)
