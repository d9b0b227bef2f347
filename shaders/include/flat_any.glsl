// Kernels that are the same for single words and for vec4s: with WIDE defined, VALUE and the accessors are of vec4s. The wide
// variant serves where every count, stride and offset is a multiple of 4 words.
#ifdef WIDE
#define VALUE vec4
#define READ(number, name) READ4(number, name)
#define WRITE(number, name) WRITE4(number, name)
#define LOAD(name, i) load4(name, i)
#define STORE(name, i, v) store4(name, i, v)
#define ADD(name, i, v, accumulate) add4(name, i, v, accumulate)
#else
#define VALUE float
#define READ(number, name) READ1(number, name)
#define WRITE(number, name) WRITE1(number, name)
#define LOAD(name, i) load1(name, i)
#define STORE(name, i, v) { name[i] = v; }
#define ADD(name, i, v, accumulate) add1(name, i, v, accumulate)
#endif
