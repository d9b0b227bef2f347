// Linked into programs with LeakSanitizer: libraries stay loaded to the end. The Vulkan loader lets go of
// drivers and layers when an instance ends; what those leaked has no name then, and could not be told from
// leaks of this project's own.

extern "C" int dlclose(void* /*handle*/) noexcept { return 0; }
