// The API's page, made from its OpenAPI document: nothing is loaded from elsewhere. Text only, never HTML.

/** @typedef {{ [key: string]: any }} Schema a part of the OpenAPI document */
/** @typedef {[name: string, what: string, required: boolean]} Row */

/** @template {keyof DocsIds} K @param {K} id @returns {DocsIds[K]} */
const $ = (id) => /** @type {any} */ (document.getElementById(id));

/** @param {string} name @param {string} [text] @param {Node[]} children */
function element(name, text, ...children) {
  const made = document.createElement(name);
  if (text) made.textContent = text;
  made.append(...children);
  return made;
}

/** @param {Schema} schema @returns {string} */
function kind(schema) {
  if (schema.const !== undefined) return JSON.stringify(schema.const);
  if (schema.enum) return schema.enum.map((/** @type {unknown} */ value) => JSON.stringify(value)).join(" | ");
  if (schema.anyOf) return schema.anyOf.map(kind).join(" or ");
  const limits = [];
  if (schema.minimum !== undefined) limits.push(`at least ${schema.minimum}`);
  if (schema.maximum !== undefined) limits.push(`at most ${schema.maximum}`);
  if (schema.maxLength !== undefined) limits.push(`at most ${schema.maxLength} characters`);
  return [schema.type, ...limits].join(", ");
}

/** @param {string} title @param {string} text @param {Row[]} fields */
function article(title, text, fields) {
  const table = element("table");
  for (const [name, what, required] of fields)
    table.append(
      element("tr", "", element("td", name), element("td", what), element("td", required ? "" : "may be left out")),
    );
  const made = element("article", "", element("h3", title));
  if (text) made.append(element("p", text));
  if (fields.length) made.append(element("div", "", table));
  made.lastElementChild?.classList.toggle("scroll", fields.length > 0);
  return made;
}

/** @type {Partial<Record<Command["type"], object>>} */
const EXAMPLES = {
  set_goal: { x: 1, y: 0.5 },
  drive: { speed: 0.3, yaw_rate: 0 },
  kidnap: {},
  step: { ticks: 1 },
  set_speed: { factor: 4 },
  set_mode: { mode: "explore" },
  reset: { seed: 7 },
  set_parameter: { name: "", value: 0 },
  edit_world: { steps: [{ do: "add", list: "walls", item: { from: [1, 1], to: [2, 1] } }] },
};

/** @param {Schema} schema @param {Schema} schemas */
function showCommands(schema, schemas) {
  for (const [type, reference] of Object.entries(schema.discriminator.mapping)) {
    const model = schemas[reference.split("/").pop()];
    const fields = Object.entries(model.properties).filter(([name]) => name !== "type");
    const required = model.required ?? [];
    $("commands").append(
      article(
        type,
        model.description,
        fields.map(([n, s]) => [n, kind(s), required.includes(n)]),
      ),
    );
    $("which").add(new Option(type, JSON.stringify({ type, ...EXAMPLES[/** @type {Command["type"]} */ (type)] })));
  }
}

/** @param {Record<string, Record<string, Schema>>} paths */
function showPaths(paths) {
  for (const [path, methods] of Object.entries(paths))
    for (const [method, operation] of Object.entries(methods)) {
      const fields = (operation.parameters ?? []).map((/** @type {Schema} */ p) => [
        p.name,
        p.description ?? kind(p.schema),
        p.required,
      ]);
      const answers = Object.entries(operation.responses).map(([status, answer]) => [status, answer.description, true]);
      $("paths").append(article(`${method.toUpperCase()} ${path}`, operation.description, [...fields, ...answers]));
    }
}

/** @param {Event} event */
async function send(event) {
  event.preventDefault();
  const answer = await fetch("/api/commands", {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: $("body").value,
  });
  $("answer").hidden = false;
  $("answer").textContent = `${answer.status}\n${JSON.stringify(await answer.json(), null, 1)}`;
}

const api = await (await fetch("/openapi.json")).json();
showCommands(api.paths["/api/commands"].post.requestBody.content["application/json"].schema, api.components.schemas);
showPaths(api.paths);
$("which").addEventListener("change", () => {
  $("body").value = $("which").value;
});
$("body").value = $("which").value;
$("form").addEventListener("submit", send);
