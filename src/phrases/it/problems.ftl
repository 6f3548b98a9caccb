# Che cosa non è stato fatto, e perché. Il dettaglio è in inglese: sta tra virgolette dove solo lui dice di che cosa si tratta.

## I titoli della pagina che dice un problema, per stato.

astray-400 = La richiesta non è stata capita
astray-401 = Non è stato fatto l'accesso
astray-403 = Questo non è permesso
astray-404 = Pagina non trovata
astray-nothing = Nessuna pagina di hallsweep ha questo indirizzo. Forse è scritto male, o ciò a cui portava non c'è più.
astray-408 = La richiesta è arrivata troppo lentamente
astray-409 = Ora questa richiesta non è possibile
astray-421 = hallsweep non ha questo nome
astray-500 = In hallsweep qualcosa è andato storto
astray-503 = Per il momento questa richiesta non si può eseguire

## Per codice: che cosa rifiuta il nucleo, nelle parole di un'altra versione.

problem-refused = è stato rifiutato: «{ $detail }»

## Che cosa non gli arriva.

problem-malformed = la richiesta non si può leggere: «{ $detail }»
problem-moreOpen = in quest'area resta aperto più di quanto mostrava la pagina: rileggere i dati, poi chiudere l'area
problem-unusable = un valore inviato non va bene: «{ $detail }»
problem-tooLarge = la richiesta è troppo grande: «{ $detail }»
problem-tooSlow = la richiesta è arrivata troppo lentamente: riprovare
problem-unsupportedMediaType = questo formato qui non si legge: «{ $detail }»
problem-methodNotAllowed = questo indirizzo non risponde a una richiesta di questo tipo: «{ $detail }»
problem-notAcceptable = non c'è in nessuno dei formati richiesti: «{ $detail }»
problem-notFound = non si trova: «{ $detail }»
problem-noHall = non c'è nessuna sala con questo nome, o questa chiave non la vede
problem-notSignedIn = nessuno ha fatto l'accesso: accedere a /sign-in; i token si vedono con hallsweep token sulla sua macchina
problem-foreignOrigin = l'ha inviata una pagina di un'altra origine: i comandi si accettano dalla pagina di hallsweep e dai programmi
problem-foreignHost = questo non è un nome di hallsweep: chiamarlo con il suo indirizzo (sulla sua macchina: localhost), o elencare in http.hosts i nomi con cui lo si raggiunge
problem-tooManyStreams = sono aperti troppi flussi di eventi: chiuderne uno
problem-tooManyRuns = troppe prove del laboratorio sono in attesa: riprovare tra poco
problem-tooManyReports = altri rapporti sono in corso: riprovare quando uno è finito
problem-noPlace = tutti i posti per un collegamento sono occupati: «{ $detail }»
problem-noDate = l'orologio della macchina non è regolato: «{ $detail }»
problem-internal = un errore in hallsweep ha interrotto questa richiesta; il suo log dice di più
problem-shuttingDown = hallsweep si sta spegnendo
problem-unreadable = il registro non si può leggere: «{ $detail }»

## Del simulatore.

problem-boundToHall = non è possibile durante una missione: attendere che finisca, o premere ARCHIVIA, che conserva ciò che è stato trovato
problem-notSimulated = il robot della ricerca non è simulato: non c'è un simulatore da comandare
problem-exerciseRunning = è in corso un'esercitazione, e il simulatore rivelerebbe i bagagli di prova: sarà visibile quando ogni bagaglio avrà il suo verdetto o la missione sarà chiusa, e si potrà modificare solo dopo un avvio senza --exercise
problem-notPaused = il simulatore non è in pausa: metterlo prima in pausa, poi andare avanti passo per passo
problem-nothingUnderWay = nessun robot ha un ordine in corso: un passo porta alla fine di un ordine; premere prima AVVIA
problem-unusableHall = questa sala non si può usare: «{ $detail }»
problem-notBlocked = qui non si può mettere un ostacolo: serve una cella libera di questa sala, e gli ostacoli non devono essere troppi
problem-hallNotKept = i robot sono nella nuova sala, ma dopo un riavvio ci sarà di nuovo quella di prima: «{ $detail }»
problem-notAName = il nome di una sala conservata ha lettere minuscole, cifre e «-», al massimo 40
problem-nameTaken = una sala di hallsweep o delle impostazioni si chiama già così: scegliere un altro nome
problem-tooManyKept = non si possono conservare altre sale: prima eliminarne una
problem-noDataFolder = senza cartella dei dati non si conservano sale: scaricare il file, o avviare hallsweep con --data
problem-cannotChangeKept = le sale conservate non si possono cambiare: «{ $detail }»
problem-anotherKept = un'altra sala è già conservata con questo nome: sostituirla, o scegliere un altro nome
