// The log: lines on standard error, one for each event, "candild[pid] level: text". It is the only global state.
#ifndef CANDIL_BASE_LOG_H
#define CANDIL_BASE_LOG_H

enum log_level { LOG_ERROR, LOG_WARNING, LOG_INFO, LOG_DEBUG };

// Set the program's name and the least urgent level that is written. $CANDIL_LOG (error, warning, info, debug) overrides
// `level`. Call once, before any thread starts. Before that call the name is "candil" and the level LOG_INFO.
void log_init(const char *program, enum log_level level);

// Write one line, in one piece. Any thread.
void log_line(enum log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
