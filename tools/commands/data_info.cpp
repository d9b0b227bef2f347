#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "tools/command.h"
#include "tools/foreign_data_option.h"
#include "train/count_progress.h"
#include "train/formats/data_summary.h"
#include "train/interrupt.h"

namespace vkopple {
namespace {

struct Options {
  std::string path;
  ForeignData data;
  uint64_t limit = UINT64_MAX;
  bool json = false;
};

void run(const Options& o) {
  const auto reader = o.data.open(o.path);
  const Interrupt interrupt;
  CountProgress progress("scenes", std::min(reader->count().value_or(0), o.limit));
  DataSummary summary;
  uint64_t scenes = 0;
  for (; scenes < o.limit && !interrupt.requested(); progress.show(++scenes)) {
    const auto scene = reader->next();
    if (!scene) break;
    summary.add(*scene);
  }
  progress.clear();
  if (o.json) {
    fmt::print("{}\n", summary.to_json().dump(2));
    return;
  }
  fmt::print("{}", summary.to_text());
  for (const std::string& warning : summary.warnings()) fmt::print("warning: {}\n", warning);
}

}  // namespace

void add_data_info(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("data-info", "Tell what a data set of any format holds, and what is odd");
  const auto o = std::make_shared<Options>();
  command->add_option("path", o->path, "A file or folder")->required();
  add_foreign_data_options(*command, o->data);
  command->add_option("--limit", o->limit, "Look at so many scenes only")
      ->check(CLI::Range(uint64_t{1}, UINT64_MAX));
  command->add_flag("--json", o->json, "Print JSON");
  command->footer(
      "Examples: vkopple data-info rooms\n"
      "          vkopple data-info recording --limit 10 --json\n" +
      formats_help(FormatUse::kReading));
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
