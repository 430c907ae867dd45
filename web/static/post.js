// A change that is no command: JSON to one of the routes.

import { sentence } from "./files.js";

// Resolves to what the server told; what was wrong is in `wrong`, in sentences, and `field` says where.
export async function post(path, body) {
  try {
    const answer = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    const told = await answer.json();
    if (answer.ok) return told;
    return { wrong: told.detail.map((wrong) => sentence(wrong.reason)).join(" "), field: told.detail[0].field };
  } catch {
    return { wrong: "The connection is lost; nothing was changed.", field: null };
  }
}

// The worlds that have been saved, and those that come with the program: titles by name.
export async function worlds() {
  try {
    return await (await fetch("/api/worlds")).json();
  } catch {
    return { yours: {}, ours: {} };
  }
}
