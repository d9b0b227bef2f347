// FOR4(i, first, count, body): body for i = first … first + 3, as far as i < count.
#define FOR4(i, first, count, body) \
  for (uint i = (first); i < min((first) + 4u, uint(count)); ++i) body
