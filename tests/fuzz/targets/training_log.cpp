#include "train/training_log.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/report/training_curves.h"

namespace vkopple::fuzz {

/// A run's log, as the report reads it, and as a run that goes on after three steps.
void training_log(Input input) {
  const InputFile file(input);
  tolerate([&] {
    for (const auto& [name, curve] : read_training_curves(file.path()).losses) stretches(curve, 5);
  });
  const TrainingLog log(file.path(), 3);
  read_training_curves(file.path());
}

}  // namespace vkopple::fuzz
