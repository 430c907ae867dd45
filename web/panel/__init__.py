"""The side panel: what each of its tabs is sent. The page draws it (static/panel)."""
