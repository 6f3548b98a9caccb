// Speaks MQTT 3.1.1 or 5 with MQTT.js, over TCP or over WebSocket, as a test tells it; talk.py says how that is told, and what is printed.

import { createInterface } from "node:readline";
import mqtt from "mqtt";

const hello = JSON.parse(process.argv[2]);
const tell = (line) => process.stdout.write(`${line}\n`);
const at = `${hello.host}:${hello.port}`;
let leaving = false;

const client = mqtt.connect(hello.web ? `ws://${at}/mqtt` : `mqtt://${at}`, {
  protocolVersion: hello.five ? 5 : 4,
  properties: hello.five ? { sessionExpiryInterval: hello.remembered ? 300 : 0 } : undefined,
  reconnectPeriod: 0,
  clientId: hello.id,
  clean: !hello.remembered,
  keepalive: hello.keepalive_s,
  username: hello.name || undefined,
  password: hello.name ? hello.password : undefined,
  will: hello.will || undefined,
  wsOptions: { headers: hello.headers },
});

client.on("connect", () => {
  tell("Connected");
  if (hello.follow.length > 0) {
    // What was granted is told below, as the broker says it.
    client.subscribe(Object.fromEntries(hello.follow.map(([topic, qos]) => [topic, { qos }])), () => {});
  }
});
client.on("packetreceive", (packet) => {
  if (packet.cmd === "suback") tell(`Subscribed: ${packet.granted.join(", ")}`);
});
client.on("message", (topic, payload, packet) => {
  tell(JSON.stringify({ topic, qos: packet.qos, retain: packet.retain ? 1 : 0, payload: payload.toString() }));
});
client.on("error", (error) => tell(`Refused: ${error.message}`));
client.on("close", () => {
  if (!leaving) tell("Closed");
  process.exit(0);
});

for await (const line of createInterface({ input: process.stdin })) {
  const { topic, payload, qos, retain } = JSON.parse(line);
  client.publish(topic, payload, { qos, retain }, () => tell("Said"));
}
leaving = true;
client.end();
