#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string_view>

#include "graph/ops/leaky_relu.h"
#include "onnx.pb.h"
#include "tests/support/exchange_model.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/exchange/colour_order.h"
#include "train/exchange/onnx/onnx_export.h"
#include "train/exchange/onnx/onnx_graph.h"
#include "train/exchange/onnx/onnx_translators.h"

namespace vkopple {
namespace {

using test::TempFolder;
using testing::ElementsAre;

using Ints = std::vector<std::int64_t>;

onnx::ModelProto exported(const ModelWeights& weights, std::int64_t batch = 1, bool bgr = false) {
  const TempFolder folder;
  export_onnx(folder / "m.onnx", weights, batch, bgr);
  const auto bytes = read_file(folder / "m.onnx", size_t{64} << 20);
  onnx::ModelProto model;
  EXPECT_TRUE(model.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
  return model;
}

Ints sizes(const onnx::ValueInfoProto& info) {
  Ints dims;
  for (const auto& dim : info.type().tensor_type().shape().dim()) dims.push_back(dim.dim_value());
  return dims;
}

/// Throws where there is none of that name.
const onnx::TensorProto& constant(const onnx::GraphProto& graph, const std::string& name) {
  const auto found = std::find_if(graph.initializer().begin(), graph.initializer().end(),
                                  [&](const auto& c) { return c.name() == name; });
  if (found == graph.initializer().end()) throw std::runtime_error("no constant " + name);
  return *found;
}

/// A constant's whole numbers.
Ints ints(const onnx::TensorProto& tensor) {
  Ints values(tensor.raw_data().size() / sizeof(std::int64_t));
  std::memcpy(values.data(), tensor.raw_data().data(), values.size() * sizeof(std::int64_t));
  return values;
}

/// What a graph says of its tensors, and how often it uses each kind of node.
struct Inspection {
  std::set<std::string> defined;
  std::map<std::string, int> kinds;
};

/// Every name is defined once, and before it is used; constants have the bytes of their shapes.
Inspection inspect(const onnx::GraphProto& graph) {
  Inspection seen;
  const auto define = [&](const std::string& name) { EXPECT_TRUE(seen.defined.insert(name).second) << name; };
  for (const auto& input : graph.input()) define(input.name());
  for (const auto& tensor : graph.initializer()) {
    define(tensor.name());
    const std::int64_t count =
        std::accumulate(tensor.dims().begin(), tensor.dims().end(), std::int64_t{1}, std::multiplies<>());
    const std::int64_t element = tensor.data_type() == onnx::TensorProto::INT64 ? 8 : 4;
    EXPECT_EQ(static_cast<std::int64_t>(tensor.raw_data().size()), count * element) << tensor.name();
  }
  std::set<std::string> names;
  for (const auto& node : graph.node()) {
    EXPECT_TRUE(names.insert(node.name()).second) << node.name();
    for (const auto& input : node.input())
      EXPECT_TRUE(seen.defined.contains(input)) << node.name() << ": " << input;
    for (const auto& output : node.output()) define(output);
    ++seen.kinds[node.op_type()];
  }
  for (const auto& output : graph.output()) EXPECT_TRUE(seen.defined.contains(output.name())) << output.name();
  return seen;
}

TEST(OnnxExport, TheModelIsWhole) {
  const ModelWeights weights = test::drawn_weights();
  const onnx::ModelProto model = exported(weights, 2);
  EXPECT_EQ(model.ir_version(), 8);
  ASSERT_EQ(model.opset_import_size(), 1);
  EXPECT_EQ(model.opset_import(0).version(), 17);
  const Inspection seen = inspect(model.graph());
  // Depth network: 6 Downs of two convolutions, 6 Ups of one and a transposed one, the first and the last.
  // Object network: 7 Downs, 7 Ups whose convolution is taken apart for skip and own part, 6 of the ASPP, the
  // first and the last.
  EXPECT_EQ(seen.kinds.at("Conv"), (2 * 6 + 6 + 2) + (2 * 7 + 2 * 7 + 6 + 2));
  EXPECT_EQ(seen.kinds.at("ConvTranspose"), 6 + 7);
  EXPECT_EQ(seen.kinds.at("BatchNormalization"), (2 * 5 + 2 * 5) + (2 * 7 + 2 * 7 + 6));
  EXPECT_EQ(seen.kinds.at("LSTM"), 1);
  std::map<std::string, Ints> ends;
  for (const auto* list : {&model.graph().input(), &model.graph().output()})
    for (const auto& info : *list) ends[info.name()] = sizes(info);
  EXPECT_EQ(ends, (std::map<std::string, Ints>{{"images", {2, 3, 16, 16}},
                                               {"depth", {2, 1, 16, 16}},
                                               {"masks", {2, 3, 16, 16}},
                                               {"location", {2, 2, 3}},
                                               {"log_pose", {2, 2, 12}},
                                               {"code", {2, 2, 12}}}));
  std::map<std::string, std::string> said;
  for (const auto& entry : model.metadata_props()) said[entry.key()] = entry.value();
  EXPECT_EQ(said.at("config"), weights.header.config.to_json());
  EXPECT_EQ(said.at("colours"), "rgb");
}

/// All weights of the two networks that single images pass are there under their names, but the LSTM's, whose
/// gates lie in another order.
TEST(OnnxExport, HoldsTheWeights) {
  const ModelWeights weights = test::drawn_weights();
  const onnx::ModelProto model = exported(weights);
  std::map<std::string, const onnx::TensorProto*> constants;
  for (const auto& tensor : model.graph().initializer()) constants[tensor.name()] = &tensor;
  for (const auto& [name, tensor] : weights.tensors) {
    const bool other = name.find("imag_net") != std::string::npos || name.find(".rnn.") != std::string::npos ||
                       name.ends_with("num_batches_tracked");
    EXPECT_EQ(constants.contains(name), !other) << name;
    if (other || !constants.contains(name)) continue;
    const std::string& raw = constants.at(name)->raw_data();
    EXPECT_EQ(std::memcmp(raw.data(), tensor.bytes.data(), raw.size()), 0) << name;
    EXPECT_TRUE(std::equal(tensor.shape.begin(), tensor.shape.end(), constants.at(name)->dims().begin(),
                           constants.at(name)->dims().end()))
        << name;
  }
}

/// i o f g where the weights have i f g o.
TEST(OnnxExport, OrdersTheGates) {
  const ModelWeights weights = test::drawn_weights();
  const onnx::ModelProto model = exported(weights);
  const auto& nodes = model.graph().node();
  const auto lstm =
      std::find_if(nodes.begin(), nodes.end(), [](const auto& n) { return n.op_type() == "LSTM"; });
  ASSERT_NE(lstm, nodes.end());
  const std::array<std::pair<int, const char*>, 2> inputs{{{1, "rnn.weight_ih_l0"}, {2, "rnn.weight_hh_l0"}}};
  for (const auto& [input, name] : inputs) {
    const auto& bytes = weights.tensors.at(std::string("segmentation_model.seg_net.seg_net.") + name).bytes;
    const size_t gate = bytes.size() / 4;
    const onnx::TensorProto& gates = constant(model.graph(), lstm->input(input));
    ASSERT_EQ(gates.raw_data().size(), bytes.size());
    const std::array<size_t, 4> order{0, 3, 1, 2};
    for (size_t g = 0; g < order.size(); ++g)
      EXPECT_EQ(std::memcmp(gates.raw_data().data() + g * gate, bytes.data() + order[g] * gate, gate), 0)
          << name << g;
  }
}

/// In what sees the image, and nowhere else.
TEST(OnnxExport, SwapsColours) {
  const ModelWeights weights = test::drawn_weights();
  std::map<std::string, StoredTensor> swapped = weights.tensors;
  swap_red_and_blue(swapped);
  const auto bytes = [](const StoredTensor& tensor) {
    return std::string(reinterpret_cast<const char*>(tensor.bytes.data()), tensor.bytes.size());
  };
  const onnx::ModelProto rgb = exported(weights), bgr = exported(weights, 1, true);
  for (const char* name :
       {"depth_model.depth_net.inc.conv.0.weight", "segmentation_model.seg_net.seg_net.inc.conv.0.weight",
        "depth_model.depth_net.outc.conv.weight"}) {
    SCOPED_TRACE(name);
    EXPECT_EQ(constant(rgb.graph(), name).raw_data(), bytes(weights.tensors.at(name)));
    EXPECT_EQ(constant(bgr.graph(), name).raw_data(), bytes(swapped.at(name)));
    const bool sees_images = std::string_view(name).find("inc") != std::string_view::npos;
    EXPECT_EQ(constant(bgr.graph(), name).raw_data() != constant(rgb.graph(), name).raw_data(), sees_images);
  }
}

/// Behind the slots' logits lie those of the background, one zero that is spread over the image.
TEST(OnnxExport, TheBackgroundsLogitsAreOneNumber) {
  const onnx::ModelProto model = exported(test::drawn_weights(), 2);
  const auto& nodes = model.graph().node();
  const auto made = [&](const std::string& tensor) -> const onnx::NodeProto& {
    const auto found = std::find_if(nodes.begin(), nodes.end(), [&](const auto& n) {
      return n.output_size() == 1 && n.output(0) == tensor;
    });
    if (found == nodes.end()) throw std::runtime_error("no node makes " + tensor);
    return *found;
  };
  const onnx::NodeProto& softmax = made(made("masks").input(0));
  EXPECT_EQ(softmax.op_type(), "Softmax");
  const onnx::NodeProto& all = made(softmax.input(0));
  ASSERT_EQ(all.op_type(), "Concat");
  const onnx::NodeProto& background = made(all.input(1));
  ASSERT_EQ(background.op_type(), "Expand");
  const onnx::TensorProto& zero = constant(model.graph(), background.input(0));
  EXPECT_EQ(zero.dims_size(), 0);
  EXPECT_EQ(zero.raw_data(), std::string(sizeof(float), '\0'));
  EXPECT_EQ(ints(constant(model.graph(), background.input(1))), (Ints{2, 1, 16, 16}));
}

TEST(OnnxExport, TakesTheDistanceOfWindowsFromDepth) {
  ModelWeights weights = test::drawn_weights();
  const auto sums = [&] { return inspect(exported(weights).graph()).kinds["ReduceSum"]; };
  EXPECT_EQ(sums(), 0);
  weights.header.config.model.mask_window = 0.7;
  EXPECT_EQ(sums(), 1);
}

TEST(OnnxExport, TakesLocationsFromMasks) {
  ModelWeights weights = test::drawn_weights();
  const auto centroids = [&] { return inspect(exported(weights).graph()).kinds["Div"]; };
  EXPECT_EQ(centroids(), 0);
  weights.header.config.model.mask_location = true;
  EXPECT_EQ(centroids(), 1);
}

TEST(OnnxExport, RefusesRotationInSpace) {
  ModelWeights weights = test::drawn_weights();
  weights.header.config.model.orientation = Orientation::kEuler;
  const TempFolder folder;
  test::expect_error([&] { export_onnx(folder / "m.onnx", weights, 1, false); },
                     {"m.onnx", "3D rotation", ".onnx", ".safetensors"});
  EXPECT_EQ(folder.entries(), 0U);
}

/// Values of small graphs, and the nodes that they become.
class OnnxGraphTest : public testing::Test {
 protected:
  OnnxGraph written() {
    OnnxGraph made(graph_, weights_, out_);
    for (const auto& [name, value] : graph_.inputs()) made.define(value, name);
    return made;
  }
  std::vector<std::string> kinds() const {
    std::vector<std::string> types;
    for (const auto& node : out_.node()) types.push_back(node.op_type());
    return types;
  }
  /// The whole numbers that input `i` of node `n` is.
  Ints ints(int n, int i) const { return vkopple::ints(constant(out_, out_.node(n).input(i))); }

  Graph graph_;
  std::map<std::string, StoredTensor> weights_;
  onnx::GraphProto out_;
};

TEST_F(OnnxGraphTest, ViewsOfRowsAreSlicesOfTheFlatTensor) {
  const Value x = graph_.input("x", row_major({4, 2, 32}));
  const Value part = graph_.slice_outer(x, 1, 2);
  const Value again = graph_.reshape(graph_.slice_outer(part, 1, 1), row_major({8, 8}));
  OnnxGraph onnx = written();
  onnx.tensor(again.id());
  EXPECT_THAT(kinds(), ElementsAre("Reshape", "Slice", "Reshape"));
  EXPECT_THAT(ints(0, 1), ElementsAre(-1));
  EXPECT_THAT(ints(1, 1), ElementsAre(128));
  EXPECT_THAT(ints(1, 2), ElementsAre(192));
  EXPECT_THAT(ints(2, 1), ElementsAre(8, 8));
  const std::string first = onnx.tensor(part.id());
  EXPECT_EQ(onnx.tensor(part.id()), first);
}

TEST_F(OnnxGraphTest, ViewsOfChannelsAreSlicesOfSamples) {
  const Value x = graph_.input("x", channels4({3, 5, 4, 8}));
  const Value part = graph_.slice_outer(x, 2, 1);
  OnnxGraph onnx = written();
  onnx.tensor(part.id());
  EXPECT_THAT(kinds(), ElementsAre("Slice"));
  EXPECT_THAT(ints(0, 1), ElementsAre(2));
  EXPECT_THAT(ints(0, 2), ElementsAre(3));
  EXPECT_THAT(ints(0, 3), ElementsAre(0));
  const Value folded = graph_.reshape(x, channels4({1, 8, 12, 8}));
  test::expect_error([&] { onnx.tensor(folded.id()); }, {"(1, 8, 12, 8)", "no form in ONNX"});
}

TEST_F(OnnxGraphTest, RefusesWhatHasNoForm) {
  EXPECT_EQ(find_onnx_translator("splat"), nullptr);
  const Value x = graph_.input("x", row_major({2, 3}));
  const Value made = leaky_relu(x, 0.1F);
  OnnxGraph onnx = written();
  test::expect_error([&] { onnx.tensor(made.id()); }, {"(2, 3)", "before it is made"});
  test::expect_error([&] { (void)onnx.weight(x.id()); }, {"(2, 3) is no weight"});
  const Value w = graph_.parameter("g", "w", {2});
  OnnxGraph without(graph_, weights_, out_);
  test::expect_error([&] { (void)without.weight(w.id()); }, {"no values of the weight w"});
}

}  // namespace
}  // namespace vkopple
