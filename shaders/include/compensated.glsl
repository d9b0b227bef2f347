// Kahan's compensated sum: sum - lost is the sum of the terms to nearly twice the digits. `type` is float or a vector.
// Statistics need it: an error of a channel's scale is the same at every pixel, so that later layers amplify it whole.
#define ADD_COMPENSATED(type, sum, lost, term) \
  {                                            \
    precise type added_ = (term) - lost;       \
    precise type next_ = sum + added_;         \
    precise type left_ = (next_ - sum) - added_; \
    lost = left_;                              \
    sum = next_;                               \
  }
