#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "runtime/device.h"
#include "runtime/error.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/other_file.h"
#include "train/checkpoint.h"
#include "train/exchange/example.h"
#include "train/exchange/model_weights.h"
#include "train/exchange/onnx/onnx_export.h"
#include "train/run_folder.h"

namespace vkopple {
namespace {

constexpr std::string_view kOnnx = ".onnx";
constexpr std::array<std::string_view, 4> kEndings{".pt", ".pth", ".safetensors", kOnnx};

struct Options {
  std::string model;
  std::string out;
  bool bgr = false;
  int batch = 1;
  std::string example;
  std::string device;
};

void require_sense(const Options& o) {
  const std::string ending = std::filesystem::path(o.out).extension().string();
  if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end())
    throw UsageError(fmt::format("{}: what is exported ends with .pt, .safetensors or .onnx", o.out));
  if (ending != kOnnx && (o.batch != 1 || !o.example.empty()))
    throw UsageError("--batch and --example go with .onnx alone: the other formats hold weights");
  if (o.bgr && !o.example.empty()) throw UsageError("--example shows red, green, blue; leave out --bgr");
}

void run(const Options& o) {
  require_sense(o);
  const std::filesystem::path checkpoint = named_checkpoint(o.model);
  require_other_file(o.out, checkpoint);
  require_other_file(o.example, checkpoint);
  const ModelWeights weights = read_model_weights(checkpoint);
  if (o.out.ends_with(kOnnx))
    export_onnx(o.out, weights, o.batch, o.bgr);
  else
    export_weights(o.out, weights, o.bgr);
  fmt::print("{}: the model of {} after {} steps\n", o.out, checkpoint.string(), weights.header.position.step);
  if (o.example.empty()) return;
  const Device device({.selector = o.device});
  write_example(o.example, device, load_model(device, checkpoint), o.batch, 0);
  fmt::print("{}: images of noise with what the model sees in them\n", o.example);
}

}  // namespace

void add_export(CLI::App& app) {
  CLI::App* command = app.add_subcommand("export", "Write a model for PyTorch, safetensors or ONNX");
  const auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "A checkpoint, or the folder of a run")->required();
  command
      ->add_option(
          "out", o->out,
          "The file to write: .pt (a state dict for PyTorch), .safetensors (the weights without the state of "
          "training) or .onnx (single images: depth, masks, objects)")
      ->required();
  command->add_flag("--bgr", o->bgr,
                    "Swap red and blue: for programs that show the model blue, green, red, as the authors do");
  command->add_option("--batch", o->batch, "Images at a time, of an .onnx")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  command->add_option(
      "--example", o->example,
      "Also write images and what the model sees in them, as .safetensors, to hold an .onnx against");
  add_device_option(*command, o->device);
  command->footer("Example: vkopple export run model.onnx");
  command->callback([o] { run(*o); });
}

}  // namespace vkopple
