// A relay on a separate port between the browser and the program, which a scenario can cut and restore like a
// network.

import { createServer, connect } from 'node:net';

/**
 * Relay to this program: `cut` closes all connections and refuses new ones, `hold` accepts data and forwards nothing,
 * `mend` ends both.
 */
export async function relay(program) {
  const { hostname, port, pathname } = new URL(program);
  const open = new Set();
  let isHeld = false;
  const take = (near) => {
    open.add(near);
    near.on('error', () => {}).on('close', () => open.delete(near));
    if (isHeld) return near.resume();
    const far = connect(Number(port), hostname);
    far.on('error', () => near.destroy()).on('close', () => near.destroy());
    near.on('close', () => far.destroy());
    return near.pipe(far).pipe(near);
  };
  let server;
  let own = 0;
  const listen = () => new Promise((done) => {
    server = createServer(take).listen(own, '127.0.0.1', () => {
      own = server.address().port;
      done();
    });
  });
  const end = () => open.forEach((near) => near.destroy());
  await listen();
  return {
    url: `http://127.0.0.1:${own}${pathname.replace(/\/$/, '')}`,
    async cut() {
      const closed = new Promise((done) => server.close(done));
      end();
      await closed;
    },
    async hold() {
      isHeld = true;
      end();
    },
    async mend() {
      end();
      isHeld = false;
      if (!server.listening) await listen();
    },
    close() {
      end();
      server.close();
    },
  };
}
