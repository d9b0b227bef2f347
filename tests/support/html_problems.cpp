#include "tests/support/html_problems.h"

#include <algorithm>
#include <set>

namespace vkopple::test {
namespace {

const std::set<std::string, std::less<>> kVoid{"meta", "link", "img", "br", "hr", "input"};
const std::set<std::string, std::less<>> kFetching{"src", "href", "srcset", "poster", "action", "data"};

class Reader {
 public:
  explicit Reader(std::string_view page) : rest_(page) {}

  std::vector<std::string> problems() {
    while (next()) {
    }
    for (const std::string& name : open_) say("is not closed", name);
    for (const std::string& id : links_)
      if (!ids_.contains(id)) say("is linked to and not there", id);
    return problems_;
  }

 private:
  void say(std::string_view what, std::string_view of) {
    problems_.push_back(std::string(of) + " " + std::string(what));
  }

  std::string_view up_to(std::string_view end) {
    const std::size_t at = rest_.find(end);
    const std::string_view text = rest_.substr(0, at);
    rest_.remove_prefix(at == std::string_view::npos ? rest_.size() : at + end.size());
    return text;
  }

  bool next() {
    if (up_to("<").find('>') != std::string_view::npos) say("stands between tags", ">");
    if (rest_.empty()) return false;
    if (rest_[0] == '!') {
      up_to(">");
    } else if (rest_[0] == '/') {
      close(up_to(">").substr(1));
    } else {
      begin();
    }
    return true;
  }

  void close(std::string_view name) {
    if (open_.empty() || open_.back() != name) return say("is closed out of turn", name);
    open_.pop_back();
  }

  void begin() {
    const std::string name(rest_.substr(0, rest_.find_first_of(" />\n")));
    rest_.remove_prefix(name.size());
    for (;;) {
      rest_.remove_prefix(std::min(rest_.find_first_not_of(" \n"), rest_.size()));
      if (rest_.empty() || rest_[0] == '>' || rest_.starts_with("/>")) break;
      attribute(name);
    }
    const bool closed = up_to(">") == "/";
    if (name == "script") say("is there", name);
    if (!closed && !kVoid.contains(name)) open_.push_back(name);
    if (name == "style") style(up_to("</style>"));
  }

  void attribute(const std::string& element) {
    const std::string_view name = rest_.substr(0, rest_.find_first_of("= />\n"));
    rest_.remove_prefix(name.size());
    if (!rest_.starts_with("=\"")) {
      up_to(">");
      return say("has no value in quotes", name);
    }
    rest_.remove_prefix(2);
    const std::string value(up_to("\""));
    if (value.find('<') != std::string::npos) say("holds <", name);
    if (name == "id" && !ids_.insert(value).second) say("is given twice", value);
    if (kFetching.contains(name)) reference(element, value);
    if (name.starts_with("on")) say("is a script", name);
  }

  void reference(const std::string& element, const std::string& value) {
    if (value.starts_with("#"))
      links_.push_back(value.substr(1));
    else if (!value.starts_with("data:"))
      say("is fetched by " + element, value);
  }

  void style(std::string_view text) {
    for (const std::string_view word : {"url(", "@import"})
      if (text.find(word) != std::string_view::npos) say("is in a style", word);
    open_.pop_back();
  }

  std::string_view rest_;
  std::vector<std::string> open_, links_, problems_;
  std::set<std::string> ids_;
};

}  // namespace

std::vector<std::string> html_problems(std::string_view page) { return Reader(page).problems(); }

}  // namespace vkopple::test
