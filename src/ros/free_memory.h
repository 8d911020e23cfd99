#pragma once

namespace recognition {

/// Gives what is free of the heap back to the system, at most once in ten seconds in a process, whoever asks. Images of
/// a frame lie between blocks that live longer; their gaps would stay with the process, and grow in number. Nothing
/// where the C library is not glibc. May be called by many threads at a time.
void returnFreeMemory();

}  // namespace recognition
