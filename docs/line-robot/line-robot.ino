// A robot for hallsweep on an Arduino or ESP32: two motors, a bumper, an HC-SR04 and an LED. It speaks the protocol of
// docs/robot-line-protocol.md; to build one, change the names, pins and times at the top. It moves by time, without encoders.

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIRE Serial  // or another serial device of the board, as Serial1

const char NAME[] = "ada";
const unsigned long STEP_MS = 800, TURN_MS = 650;  // one cell, 90 degrees
const unsigned long WATCHDOG_MS = 400;
const int LEFT_AHEAD = 5, LEFT_BACK = 6, RIGHT_AHEAD = 9, RIGHT_BACK = 10;
const int BUMPER = 2, BLINKER = 13, TRIGGER = 7, ECHO_PIN = 8;

// Where it stands: at home, facing south, when it is switched on. Headings are counted clockwise from the north.
const char *const HEADINGS[] = {"north", "east", "south", "west"};
const int EAST_OF[] = {0, 1, 0, -1}, SOUTH_OF[] = {-1, 0, 1, 0};
int x = 0, y = 0, heading = 2;
long astray = 0;      // so many milliseconds it has left the centre: ahead or to the left, behind or to the right when negative
bool turned = false;  // whether that was a turn

char task = 0;                 // the letter of the order under way; 0: none, and the motors stand
unsigned long seq, deadline;   // its number, and after how long it halts by itself
unsigned long begun, moved;    // when it began, and until when `astray` counts
unsigned long last = 0;        // the greatest number begun or voided; 0: it has heard no `from`, and obeys no order
unsigned long answered = 0;    // the order of the last answer
char answer[60];
unsigned long heard = 0;       // when the last good line came
bool blinks = false;

uint16_t crc16(const char *text) {
  uint16_t crc = 0xffff;
  for (; *text; text++) {
    crc ^= (uint16_t)((uint8_t)*text << 8);
    for (int bit = 0; bit < 8; bit++) crc = (crc & 0x8000) ? (uint16_t)((crc << 1) ^ 0x1021) : (uint16_t)(crc << 1);
  }
  return crc;
}

void say(const char *text) {
  char check[8];
  snprintf(check, sizeof check, "*%04X\n", (unsigned)crc16(text));
  WIRE.print(text);
  WIRE.print(check);
}

void sayHello() {
  char line[160];
  snprintf(line, sizeof line, "hello %s base sonar led bump step=%lu turn=%lu photo=0 at=%d,%d,%s %s last=%lu", NAME, STEP_MS,
           TURN_MS, x, y, HEADINGS[heading], astray || task ? "off" : "centred", last);
  say(line);
}

// Answers an order, and keeps the answer for when the order comes again.
void settle(unsigned long which, const char *word, const char *rest) {
  snprintf(answer, sizeof answer, "%s %lu%s%s", word, which, *rest ? " " : "", rest);
  answered = which;
  say(answer);
}

void answerAgain(unsigned long which) {
  if (which == answered) say(answer);
}

// Centimetres to what is ahead; 0: nothing within four metres.
int sonar() {
  digitalWrite(TRIGGER, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER, LOW);
  return (int)(pulseIn(ECHO_PIN, HIGH, 24000) / 58);
}

// -1, 0 or 1 for each wheel.
void motors(int left, int right) {
  digitalWrite(LEFT_AHEAD, left > 0 ? HIGH : LOW);
  digitalWrite(LEFT_BACK, left < 0 ? HIGH : LOW);
  digitalWrite(RIGHT_AHEAD, right > 0 ? HIGH : LOW);
  digitalWrite(RIGHT_BACK, right < 0 ? HIGH : LOW);
}

// Which way `astray` grows: +1 ahead or left, -1 behind or right.
int direction() {
  if (task == 'c') return astray > 0 ? -1 : 1;
  return task == 'w' || task == 'a' ? 1 : -1;
}

// The motors stand, and what was under way is answered.
void stop(const char *word, const char *rest) {
  motors(0, 0);
  task = 0;
  settle(seq, word, rest);
}

void halt() {
  if (task) stop("halted", astray ? "off" : "centred");
}

void begin(char letter) {
  if (letter != 'c') {
    if (astray) return settle(seq, "failed", "it is off centre: recentre first");
    turned = letter == 'a' || letter == 'd';
  } else if (!astray) {
    return settle(seq, "done", "");
  }
  task = letter;
  begun = moved = millis();
  motors(turned ? -direction() : direction(), direction());
}

// The motion under way is complete: it stands in the centre of a cell, which may be another.
void complete() {
  int to = task == 'c' ? 0 : direction();
  if (turned) {
    heading = (heading - to + 4) % 4;
  } else {
    x += to * EAST_OF[heading];
    y += to * SOUTH_OF[heading];
  }
  astray = 0;
  stop("done", "");
}

void move() {
  if (!task) return;
  unsigned long now = millis();
  long way = (long)(now - moved) * direction();
  bool is_back = task == 'c' && labs(way) >= labs(astray);
  astray = is_back ? 0 : astray + way;
  moved = now;
  if (is_back || (task != 'c' && (unsigned long)labs(astray) >= (turned ? TURN_MS : STEP_MS))) return complete();
  if (!turned && direction() > 0 && digitalRead(BUMPER) == LOW) {
    char what[20];
    motors(0, 0);
    int cm = sonar();
    if (cm) snprintf(what, sizeof what, "%d unknown", cm);
    return stop("blocked", cm ? what : "none unknown");
  }
  if (now - heard >= WATCHDOG_MS) return halt();
  if (now - begun >= deadline) stop("failed", "it did not finish in time");
}

void obey(char *line) {
  heard = millis();
  char *word = strtok(line, " "), *number = strtok(NULL, " "), *limit = strtok(NULL, " ");
  if (!word) return;
  if (!strcmp(word, "hello")) return sayHello();
  if (!number) return;
  if (!strcmp(word, "led")) { blinks = !strcmp(number, "blink"); return; }
  unsigned long which = strtoul(number, NULL, 10);
  if (!strcmp(word, "from")) {
    if (which > last) {
      halt();
      last = which;
      answered = 0;
    }
    sayHello();
  } else if (!strcmp(word, "h")) {
    if (task) return halt();
    if (last && which > last) settle(last = which, "halted", astray ? "off" : "centred");
    else answerAgain(which);
  } else if (limit && !word[1] && strchr("wsadc", word[0])) {
    if (!last || task) return;
    if (which <= last) return answerAgain(which);
    seq = last = which;
    deadline = strtoul(limit, NULL, 10);
    begin(word[0]);
  }
}

// Collects a line, and obeys it if its check is right. Nothing for it is longer than 40 bytes.
void hear(char letter) {
  static char line[48];
  static unsigned length = 0;
  if (letter == '\r') return;
  if (letter != '\n') {
    if (length < sizeof line) line[length] = letter;
    if (length <= sizeof line) length++;
    return;
  }
  bool fits = length < sizeof line;
  if (fits) line[length] = 0;
  length = 0;
  char *check = fits ? strchr(line, '*') : NULL;
  if (!check) return;
  *check++ = 0;
  char right[8];
  snprintf(right, sizeof right, "%04X", (unsigned)crc16(line));
  if (!strcmp(check, right)) obey(line);
}

void setup() {
  const int outputs[] = {LEFT_AHEAD, LEFT_BACK, RIGHT_AHEAD, RIGHT_BACK, BLINKER, TRIGGER};
  for (int pin : outputs) pinMode(pin, OUTPUT);
  pinMode(BUMPER, INPUT_PULLUP);  // pressed: LOW
  pinMode(ECHO_PIN, INPUT);
  motors(0, 0);
  WIRE.begin(115200);
}

void loop() {
  static unsigned long measured = 0;
  while (WIRE.available() > 0) hear((char)WIRE.read());
  move();
  digitalWrite(BLINKER, blinks && millis() / 250 % 2 ? HIGH : LOW);
  if (!task && last && millis() - measured >= 1000) {  // measuring takes 24 ms at most
    char line[20];
    measured = millis();
    int cm = sonar();
    if (cm) snprintf(line, sizeof line, "sonar %d", cm);
    say(cm ? line : "sonar none");
  }
}
