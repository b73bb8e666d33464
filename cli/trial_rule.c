#include "trial_rule.h"

#include "serve.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define MOST_ANSWER 1024
#define MOST_YAW_RAD 1e7 /* as of poses that are served */

typedef struct program {
    pid_t pid; /* 0: not running */
    int in, out;
} program;

struct trial_programs {
    const char *command;
    size_t count;
    double timeout_s;
    program each[];
};

trial_programs *trial_programs_begin(const char *command, size_t workers, double timeout_s) {
    trial_programs *p = calloc(1, sizeof *p + workers * sizeof p->each[0]);
    signal(SIGPIPE, SIG_IGN); /* a rule that ends early breaks its run alone */
    if (p) {
        *p = (trial_programs){.command = command, .count = workers, .timeout_s = timeout_s};
    }
    return p;
}

bool trial_program_exists(const char *command) {
    const char *word = command + strspn(command, " \t");
    size_t length = strcspn(word, " \t");
    char name[PATH_MAX];
    if (length >= sizeof name || strcspn(word, "=$'\"`()&;|<>{}[]*?~!#\\\n") < length) {
        return true;
    }
    snprintf(name, sizeof name, "%.*s", (int)length, word);
    pid_t pid = fork();
    if (pid == 0) {
        execl("/bin/sh", "sh", "-c", "command -v -- \"$1\" >/dev/null", "sh", name, (char *)NULL);
        _exit(127);
    }
    int status = 0;
    while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return pid < 0 || (WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void stop(program *p) {
    if (p->pid > 0) {
        close(p->in);
        close(p->out);
        kill(-p->pid, SIGKILL);
        cli_signals_group(p->pid, false); /* before the number is another's */
        waitpid(p->pid, NULL, 0);
    }
    *p = (program){.pid = 0};
}

void trial_programs_end(trial_programs **programs) {
    for (size_t i = 0; *programs && i < (*programs)->count; i++) {
        stop(&(*programs)->each[i]);
    }
    free(*programs);
    *programs = NULL;
}

/* In a group of its own, so that what a shell started ends with it. */
static bool start(program *p, const char *command, char *why) {
    int to[2] = {-1, -1}, from[2] = {-1, -1};
    p->pid = pipe2(to, O_CLOEXEC) == 0 && pipe2(from, O_CLOEXEC) == 0 ? fork() : -1;
    if (p->pid == 0) {
        setpgid(0, 0);
        cli_signals_as_found();
        dup2(to[0], STDIN_FILENO);
        dup2(from[1], STDOUT_FILENO);
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    int error = errno;
    close(to[0]); /* -1, which is no pipe, is let be */
    close(from[1]);
    p->in = to[1];
    p->out = from[0];
    if (p->pid < 0) {
        snprintf(why, ASDIC_TRIAL_WHY, "cannot start the rule: %s", strerror(error));
        close(p->in);
        close(p->out);
        p->pid = 0;
        return false;
    }
    setpgid(p->pid, p->pid);
    cli_signals_group(p->pid, true);
    return true;
}

/* How the program ended, into WHY. */
static void say_end(program *p, char *why) {
    int status = 0;
    pid_t pid = p->pid;
    struct timespec moment = {.tv_nsec = 50000000};
    for (int i = 0; i < 20 && waitpid(pid, &status, WNOHANG) == 0; i++) {
        nanosleep(&moment, NULL);
        status = -1;
    }
    if (status >= 0 && WIFSIGNALED(status)) {
        snprintf(why, ASDIC_TRIAL_WHY, "the rule was ended by signal %d", WTERMSIG(status));
    } else if (status >= 0 && WIFEXITED(status)) {
        snprintf(why, ASDIC_TRIAL_WHY, "the rule ended with code %d without an answer",
                 WEXITSTATUS(status));
    } else {
        snprintf(why, ASDIC_TRIAL_WHY, "the rule closed its output without an answer");
    }
}

/* Waits for WHAT of FD until END_S. */
static bool ready(int fd, short what, double end_s) {
    struct pollfd waits = {.fd = fd, .events = what};
    for (;;) {
        double left_s = end_s - cli_clock_s();
        int got = poll(&waits, 1, left_s > 0.0 ? (int)ceil(left_s * 1000.0) : 0);
        if (got > 0) {
            return true;
        }
        if (got == 0 || errno != EINTR) {
            return false;
        }
    }
}

/* Writes all LENGTH bytes. */
static bool put(program *p, const char *bytes, size_t length, double end_s, char *why) {
    while (length > 0) {
        if (!ready(p->in, POLLOUT, end_s)) {
            snprintf(why, ASDIC_TRIAL_WHY, "the rule does not read what it gets");
            return false;
        }
        ssize_t put = write(p->in, bytes, length < PIPE_BUF ? length : PIPE_BUF);
        if (put < 0 && errno != EINTR && errno != EAGAIN) {
            say_end(p, why);
            return false;
        }
        bytes += put > 0 ? put : 0;
        length -= put > 0 ? (size_t)put : 0;
    }
    return true;
}

/* One line without its end into ANSWER. */
static bool take(program *p, char answer[MOST_ANSWER], double timeout_s, double end_s, char *why) {
    size_t length = 0;
    for (;;) {
        if (!ready(p->out, POLLIN, end_s)) {
            snprintf(why, ASDIC_TRIAL_WHY, "the rule did not answer within %g s", timeout_s);
            return false;
        }
        ssize_t got = read(p->out, answer + length, 1);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            say_end(p, why);
            return false;
        }
        if (got > 0 && answer[length] == '\n') {
            answer[length - (length > 0 && answer[length - 1] == '\r')] = '\0';
            return true;
        }
        length += got > 0;
        if (length == MOST_ANSWER) {
            snprintf(why, ASDIC_TRIAL_WHY, "the rule's answer is longer than %d characters",
                     MOST_ANSWER - 1);
            return false;
        }
    }
}

/* Whether the program has said nothing since its last answer: another line would be taken for that to the next ping,
 * and so on. */
static bool is_quiet(program *p, char *why) {
    char more;
    if (!ready(p->out, POLLIN, 0.0)) {
        return true;
    }
    if (read(p->out, &more, 1) == 1) {
        snprintf(why, ASDIC_TRIAL_WHY, "the rule answered a ping with more than a line");
    } else {
        say_end(p, why);
    }
    return false;
}

/* The ping as serve writes it, with the vehicle's pose and what was detected. */
static bool print_ping(const asdic_trial_look *look, char **text, size_t *length) {
    const asdic_loop_ping *ping = look->ping;
    const double degree = 180.0 / CLI_PI;
    const serve_request request = {
        .value = {ping->time_s, ping->pose.position_m.x, ping->pose.position_m.y,
                  ping->pose.position_m.z, ping->pose.roll_rad * degree,
                  ping->pose.pitch_rad * degree, ping->pose.yaw_rad * degree}};
    const serve_answer answer = {.ping = ping, .detection = look->found};
    serve_writer writer = {.out = open_memstream(text, length),
                           .format = SERVE_JSON,
                           .sonar = look->sonar,
                           .bins = ping->bins,
                           .bin_length_m = ping->bin_length_m,
                           .has_detections = true};
    if (!writer.out) {
        return false;
    }
    serve_write_ping(&writer, 0, &request, &answer);
    return fclose(writer.out) == 0;
}

/* {}, or the depth or heading to be flown. */
static bool read_answer(const char *answer, asdic_trial_order *order, char *why) {
    double value[SERVE_COLUMNS];
    char wrong[SERVE_WHY_SIZE];
    if (!serve_read_object(answer, value, wrong)) {
        snprintf(why, ASDIC_TRIAL_WHY,
                 "the rule answered '%.40s': %.150s (it can ask for z_m and yaw_deg)", answer,
                 wrong);
        return false;
    }
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        if (i != SERVE_Z && i != SERVE_YAW && !isnan(value[i])) {
            snprintf(why, ASDIC_TRIAL_WHY, "the rule asks for %s; it can ask for z_m and yaw_deg",
                     serve_columns[i]);
            return false;
        }
    }
    order->dives = !isnan(value[SERVE_Z]);
    order->turns = !isnan(value[SERVE_YAW]);
    order->z_m = order->dives ? value[SERVE_Z] : 0.0;
    order->yaw_rad = order->turns ? value[SERVE_YAW] * CLI_PI / 180.0 : 0.0;
    if (fabs(order->yaw_rad) > MOST_YAW_RAD) {
        snprintf(why, ASDIC_TRIAL_WHY, "the rule asks for yaw_deg = %g, beyond %g degrees",
                 value[SERVE_YAW], cli_degrees(MOST_YAW_RAD));
        return false;
    }
    if (order->dives && !(order->z_m >= 0.0 && order->z_m <= 11000.0)) {
        snprintf(why, ASDIC_TRIAL_WHY, "the rule asks for z_m = %g, out of range [0, 11000] m",
                 order->z_m);
        return false;
    }
    return true;
}

static bool converse(program *p, double timeout_s, const asdic_trial_look *look,
                     asdic_trial_order *order, char *why) {
    char *text = NULL, answer[MOST_ANSWER];
    size_t length = 0;
    if (!print_ping(look, &text, &length)) {
        free(text);
        snprintf(why, ASDIC_TRIAL_WHY, "out of memory");
        return false;
    }
    double end_s = cli_clock_s() + timeout_s;
    bool good = is_quiet(p, why) && put(p, text, length, end_s, why) &&
                take(p, answer, timeout_s, end_s, why) && read_answer(answer, order, why);
    free(text);
    return good;
}

bool trial_programs_decide(void *programs, const asdic_trial_look *look, asdic_trial_order *order,
                           char why[ASDIC_TRIAL_WHY]) {
    trial_programs *all = programs;
    program *p = &all->each[look->worker];
    if (p->pid == 0 && !start(p, all->command, why)) {
        return false;
    }
    bool good = converse(p, all->timeout_s, look, order, why);
    if (!good) {
        stop(p);
    }
    return good;
}
