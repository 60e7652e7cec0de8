//! Checks documents, and publishes their diagnostics.

use std::collections::BTreeMap;

use lsp_server::Notification;
use serde_json::{Value, json};

use crate::ServeError;
use crate::check;
use crate::guard::guarded;
use crate::params::RequestError;
use crate::server::{Server, send};

impl Server<'_> {
    /// Checks one document of `stale`. If no other document is left, publishes the diagnostics of all documents in
    /// `concerned`.
    pub(crate) fn check_one(&mut self) -> Result<(), ServeError> {
        let Some(uri) = self.stale.pop_first() else { return Ok(()) };
        let documents = &self.documents;
        let checked = match documents.open.get(&uri) {
            None => Ok(check::CheckResult::default()),
            Some(document) => guarded(|| Ok(check::check(documents, &uri, document, self.book.as_deref()))),
        };
        match checked {
            Ok(checked) => self.keep(uri, checked),
            Err(RequestError { message, .. }) => self.log(&format!("check of {uri}: {message}"))?,
        }
        if !self.stale.is_empty() {
            return Ok(());
        }
        let concerned = std::mem::take(&mut self.concerned);
        concerned.iter().try_for_each(|uri| self.publish(uri))
    }

    /// Stores the diagnostics of a check, and adds to `concerned` the documents in which these diagnostics or those of
    /// the previous check are shown.
    fn keep(&mut self, uri: String, checked: check::CheckResult) {
        if checked.uses_files {
            self.users.insert(uri.clone())
        } else {
            self.users.remove(&uri)
        };
        self.concerned.extend(checked.diagnostics.keys().cloned());
        self.concerned.insert(uri.clone());
        let before = match self.documents.open.contains_key(&uri) {
            true => self.found.insert(uri, checked.diagnostics),
            false => self.found.remove(&uri),
        };
        self.concerned.extend(before.into_iter().flat_map(BTreeMap::into_keys));
    }

    /// Publishes the diagnostics in a document. A diagnostic that several checks have found is published only once.
    fn publish(&self, uri: &str) -> Result<(), ServeError> {
        let mut diagnostics: Vec<&Value> = Vec::new();
        for diagnostic in self.found.values().filter_map(|found| found.get(uri)).flatten() {
            if !diagnostics.contains(&diagnostic) {
                diagnostics.push(diagnostic);
            }
        }
        let mut params = json!({ "uri": uri, "diagnostics": diagnostics });
        if let Some(document) = self.documents.open.get(uri) {
            params["version"] = json!(document.version);
        }
        send(self.connection, Notification::new("textDocument/publishDiagnostics".into(), params))
    }
}
