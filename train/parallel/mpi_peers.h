#pragma once

#include <functional>
#include <string>

#include "train/parallel/join.h"

namespace vkopple {

/// Peers over MPI. One at a time in a process's life, as MPI begins and ends with it.
class MpiPeers : public JoinedPeers {
 public:
  explicit MpiPeers(std::function<bool()> asked_to_stop);
  ~MpiPeers() override;

  int rank() const override { return rank_; }
  int count() const override { return count_; }
  int rank_on_machine() const override { return rank_on_machine_; }
  [[noreturn]] void abandon(const std::string& message, int code) override;

 private:
  class Exchange;
  void all_gather(std::span<const float> mine, std::span<float> all) override;
  void all_to_all(std::span<const float> parts, std::span<float> mine) override;

  std::function<bool()> asked_to_stop_;
  int rank_ = 0;
  int count_ = 1;
  int rank_on_machine_ = 0;
};

}  // namespace vkopple
