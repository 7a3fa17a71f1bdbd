// Memory of the device that a kernel reads and writes.
#pragma once

namespace traffic {

// Memory that is counted from now on, and no longer.
void add(void *memory, unsigned long long bytes);
void remove(void *memory);
// A count: bytes of all sectors that were read since it began, and of those that were written.
void begin();
unsigned long long end();

} // namespace traffic
