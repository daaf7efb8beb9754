// The log: lines on standard error, one per event, "candild[pid] level: text". The one piece of global state.
#ifndef CANDIL_BASE_LOG_H
#define CANDIL_BASE_LOG_H

enum log_level { LOG_ERROR, LOG_WARNING, LOG_INFO, LOG_DEBUG };

// Set the program's name and the least urgent level written. $CANDIL_LOG (error, warning, info, debug) wins over `level`.
// Call once, before any thread starts. Before it: "candil" and LOG_INFO.
void log_init(const char *program, enum log_level level);

// One line, written whole; safe from any thread.
void log_line(enum log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
