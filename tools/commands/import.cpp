#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "models/config.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/other_file.h"
#include "tools/set_option.h"
#include "train/exchange/model_weights.h"
#include "train/exchange/open_tensor_file.h"
#include "train/run_folder.h"

namespace vkopple {
namespace {

struct Options {
  std::string file;
  std::string out;
  std::string config;
  std::vector<std::string> set;
  std::vector<std::string> without;
  bool bgr = false;
};

void run(const Options& o) {
  if (std::filesystem::path(o.out).extension() != ".safetensors")
    throw UsageError(fmt::format("{}: a checkpoint's name ends with .safetensors", o.out));
  if (o.config.empty() && !o.set.empty())
    throw UsageError("--set changes a configuration; name one by --config");
  require_other_file(o.out, o.file);
  ImportOptions options{.bgr = o.bgr, .left_out = o.without};
  if (!o.config.empty()) options.config = Config::load(o.config, o.set);
  const ModelWeights weights = import_weights(*open_tensor_file(o.file), options);
  if (const auto folder = std::filesystem::path(o.out).parent_path(); !folder.empty())
    RunFolder(folder).create();
  write_model_checkpoint(o.out, weights);
  const ModelConfig& model = weights.header.config.model;
  fmt::print("{}: {} tensors of a model of {} x {} pixels\n", o.out, weights.tensors.size(), model.height,
             model.width);
}

}  // namespace

void add_import(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("import", "Make a checkpoint of weights from PyTorch or another program");
  const auto o = std::make_shared<Options>();
  command->add_option("file", o->file, "A state dict: .pt of PyTorch, or .safetensors")->required();
  command->add_option("out", o->out, "The checkpoint to write, .safetensors")->required();
  command->add_option(
      "--config", o->config,
      "The configuration that the weights are of, a file or a preset (the authors': full); needed unless "
      "vkopple has exported them");
  add_set_option(*command, o->set);
  command->add_flag("--bgr", o->bgr, "The weights take and give blue, green, red, as the authors' do");
  command->add_option("--without", o->without, "Leave out tensors whose names begin so; may be repeated");
  command->footer("Example: vkopple import authors.pt run/latest.safetensors --config full --bgr");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
