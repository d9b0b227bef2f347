#include "train/interrupt.h"

#include <atomic>

namespace vkopple {
namespace {

// A signal handler reaches nothing but what is global.
std::atomic<bool> raised{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void raise_flag(int) { raised.store(true); }

}  // namespace

Interrupt::Interrupt() {
  raised.store(false);
  struct sigaction action {};
  action.sa_handler = raise_flag;
  // RESTART: no system call of the work under way fails. RESETHAND: the second signal is not caught.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, &interrupt_before_);
  ::sigaction(SIGTERM, &action, &terminate_before_);
}

Interrupt::~Interrupt() {
  ::sigaction(SIGINT, &interrupt_before_, nullptr);
  ::sigaction(SIGTERM, &terminate_before_, nullptr);
}

bool Interrupt::requested() const { return raised.load(); }

}  // namespace vkopple
