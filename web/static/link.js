// The page's websocket: comes back by itself, hands out what arrives, sends commands and finds their answers.

const RETRY_MS = [150, 400, 800, 1000];

export class Link extends EventTarget {
  constructor(page) {
    super();
    this.page = page;
    this.open = false;
    this.waiting = new Map(); // id -> resolve
    this.lastId = 0;
    this.tries = 0;
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/api/stream?got=1&page=${this.page}`);
    this.socket = socket;
    const slow = setTimeout(() => socket.close(), 3000);
    socket.onopen = () => {
      clearTimeout(slow);
      this.tries = 0;
      this.open = true;
    };
    socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      if (message.type === "answer") this.settle(message);
      else this.dispatchEvent(new CustomEvent(message.type, { detail: message }));
      if (message.type === "state") this.tell({ type: "got" }); // the next, please: the newest there is by then
    };
    socket.onclose = () => {
      clearTimeout(slow);
      const was = this.open;
      this.open = false;
      for (const { resolve } of this.waiting.values()) resolve({ accepted: false, detail: [] });
      this.waiting.clear();
      if (was) this.dispatchEvent(new Event("lost"));
      setTimeout(() => this.connect(), RETRY_MS[Math.min(this.tries++, RETRY_MS.length - 1)]);
    };
  }

  settle(answer) {
    const { resolve, quiet } = this.waiting.get(answer.id) ?? {};
    this.waiting.delete(answer.id);
    if (!answer.accepted && !quiet) this.dispatchEvent(new CustomEvent("refused", { detail: answer }));
    if (resolve) resolve(answer);
  }

  // Fire and forget: what is sent often, or concerns this page alone. Only a refusal is answered.
  tell(command) {
    if (this.open) this.socket.send(JSON.stringify(command));
    return this.open;
  }

  // Resolves to the answer; never rejects. quiet: whoever asks tells of a refusal.
  ask(command, { quiet = false } = {}) {
    const id = ++this.lastId;
    if (!this.tell({ ...command, id })) return Promise.resolve({ accepted: false, detail: [] });
    return new Promise((resolve) => this.waiting.set(id, { resolve, quiet }));
  }
}
