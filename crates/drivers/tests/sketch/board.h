// What the sketch uses of an Arduino, in time that passes when a line on standard input says so. Each line is answered by one: what
// the sketch has said since, in hex, and its motor pins.
//
//   hear 68656c6c6f    these bytes come over the wire
//   pass 10            so many milliseconds pass
//   bump 1             something presses the bumper
//   cm 37              what the sonar measures; 0: nothing

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <string>

const int LOW = 0, HIGH = 1, INPUT = 0, OUTPUT = 1, INPUT_PULLUP = 2;

static unsigned long now_ms = 0;
static int pins[32], cm = 0;
static bool bumps = false;
static std::deque<char> wire;
static std::string said;

unsigned long millis() { return now_ms; }
void delayMicroseconds(unsigned int) {}
void pinMode(int, int) {}
void digitalWrite(int pin, int value) { pins[pin] = value; }
int digitalRead(int) { return bumps ? LOW : HIGH; }
unsigned long pulseIn(int, int, unsigned long) { return (unsigned long)cm * 58; }

struct SerialPort {
  void begin(long) {}
  int available() { return (int)wire.size(); }
  int read() {
    char byte = wire.front();
    wire.pop_front();
    return (unsigned char)byte;
  }
  void print(const char *text) { said += text; }
};
static SerialPort Serial;

void setup();
void loop();

int main() {
  static char line[65536];
  setup();
  while (fgets(line, sizeof line, stdin)) {
    char *rest = strchr(line, ' ');
    if (!rest) return 1;
    *rest++ = 0;
    int number = atoi(rest);
    if (!strcmp(line, "hear")) {
      for (unsigned byte; sscanf(rest, "%2x", &byte) == 1; rest += 2) wire.push_back((char)byte);
    }
    if (!strcmp(line, "bump")) bumps = number;
    if (!strcmp(line, "cm")) cm = number;
    for (int ms = 0; !strcmp(line, "pass") && ms < number; ms++) {
      now_ms++;
      loop();
    }
    printf("said ");
    for (char byte : said) printf("%02x", (unsigned char)byte);
    printf(" motors %d%d%d%d\n", pins[5], pins[6], pins[9], pins[10]);
    fflush(stdout);
    said.clear();
  }
}
